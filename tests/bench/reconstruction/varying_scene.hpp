#pragma once
// Ground whose law varies, its samples, and what is said of it by ways to treat the law: for the sections that compare
// them zone by zone.

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "fractal/reconstruction/cell_samples.hpp"
#include "fractal/reconstruction/surface_problem.hpp"
#include "tests/reconstruction/surface_metrics.hpp"

namespace scree::bench {

enum class Layout { halves, patches, ramp };

/// Square ground of two laws.
struct VaryingCase {
  const char* name;
  Layout layout;
  fractal::FractalLaw one, two;  ///< amplitudes over one cell
  bool holes;
  int side = 128;       ///< cells; patches are laid out for 128
  double width = 6.2;   ///< sd of the transition: 16 cells from a tenth to nine
  double window = 0.0;  ///< sd of the window that the method sees the law through

  double true_width() const { return width; }
  double seen_width() const { return std::hypot(width, window); }
};

inline constexpr fractal::FractalLaw kSand{2.15, 0.3}, kRubble{2.6, 1.5};

/// The law with transitions of the given sd.
fractal::LawMap law_of(const VaryingCase& c, double width);

inline constexpr int kZones = 3;  ///< first law, transition, second law
/// 0, 1, 2: the share of the second law is below .1, between, above .9. A jump's transition is where its window blurs
/// it.
std::size_t zone_of(const VaryingCase& c, int row, int column);
/// RMSE, CRPS and coverage zone by zone.
using ZoneScores = std::array<fractal::PredictionScore, kZones>;

/// One ground: 5 % of the cells measured, or 7 % and holes of radius 11 (six in 128²), noise variance kNoise.
struct VaryingScene {
  static constexpr double kNoise = 1e-3;
  fractal::LawMap law;  ///< as the method sees it
  Grid<float> truth;
  fractal::CellSamples samples;

  VaryingScene(const VaryingCase& c, std::uint64_t seed);
  int side() const { return truth.rows(); }
  bool measured(int row, int column) const { return !std::isnan(samples.height_m(row, column)); }
};

/// Mean, standard deviation, the first eight draws.
struct VaryingAnswer {
  Grid<float> mean, sd;
  std::vector<Grid<float>> draws = {};
  int iterations = 0;
};

/// The factor that makes an sd from `fields` residual fields (32 or 128) give 90 % intervals: Student's quantile over
/// the normal one.
constexpr double student_factor(int fields) {
  return (fields == 32 ? 1.6939 : 1.6568) / fractal::kNormal95;
}
/// The conditional method with one law or one a cell; sd from `fields` fields, student_factor applied, or from the sd
/// map that it makes of them.
VaryingAnswer by_draws(const VaryingScene& scene, const fractal::LawMap& law, std::uint64_t seed, int fields,
                       bool map_of_sd);
/// The mean alone, solved for up to `tolerance`.
Grid<float> mean_of(const VaryingScene& scene, const fractal::LawMap& law, double tolerance);
/// One operator for the middle D and unit amplitude, data weighted with the local amplitude, residuals of the true law:
/// the cheap approximation that weights of each cell are measured against.
VaryingAnswer by_one_operator(const VaryingScene& scene, std::uint64_t seed, int fields);
/// D^ and the rms change over a cell of the whole map, as one law.
fractal::LawMap one_law(const Grid<float>& truth);

/// Adds the cells without a datum.
void score_zones(const VaryingCase& c, const VaryingScene& scene, const VaryingAnswer& answer, ZoneScores& scores);

}  // namespace scree::bench
