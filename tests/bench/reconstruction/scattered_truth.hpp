#pragma once
// Exact ground of which some points are known, for methods on scattered points, and what they make of it.

#include <array>
#include <functional>
#include <vector>

#include "core/random.hpp"
#include "fractal/reconstruction/surface_problem.hpp"
#include "tests/bench/dimension/timing.hpp"
#include "tests/reconstruction/surface_metrics.hpp"

namespace scree::bench {

/// A window in the middle of a larger surface, in cells of 0.1 m and with an rms change of 1 m over one cell: the
/// points around it hold its edges, so that every cell lies inside the hull.
struct ScatteredTruth {
  static constexpr int kMargin = 16;
  Grid<float> truth;
  Grid<std::uint8_t> known;
  fractal::HeightSamples samples;
  fractal::SurfaceRequest request;

  /// `choose(row, column)` over the larger surface.
  ScatteredTruth(double dimension, int side, std::uint64_t seed, const std::function<bool(int, int)>& choose)
      : truth(side, side), known(side, side, 0) {
    const int all = side + 2 * kMargin;
    request.grid = {side, side, 0.1};
    request.law.law = {dimension, 1.0 / std::pow(0.1, 3.0 - dimension)};
    request.seed = seed + 1;
    const Grid<float> surface = *fractal::fbm_surface(request.law.law, all, all, 0.1, seed);
    for (int r = 0; r < all; ++r)
      for (int c = 0; c < all; ++c) {
        const bool inside = truth.contains(r - kMargin, c - kMargin), chosen = choose(r, c);
        if (inside) truth(r - kMargin, c - kMargin) = surface(r, c);
        if (inside) known(r - kMargin, c - kMargin) = chosen;
        if (!chosen) continue;
        samples.x_m.push_back(0.1 * (c - kMargin + 0.5));
        samples.y_m.push_back(0.1 * (r - kMargin + 0.5));
        samples.z_m.push_back(static_cast<double>(surface(r, c)));
        samples.variance_m2.push_back(0.0);
      }
  }
};

struct Judgement {
  double roughness = 0.0;  ///< D^ of a realisation − D^ of the truth
  double draw_square = 0.0;
  fractal::PredictionScore score;  ///< of the cells not known, in rms changes over one cell
  double seconds = 0.0;            ///< CPU, all realisations
};

/// 8 realisations: the 90 % interval of a further one is ±t(7) · √(1 + 1/8) of their sd.
inline constexpr double kEightRealisations = 1.8946 * 1.0606602 / fractal::kNormal95;

using ScatteredMethod =
    std::function<Result<fractal::SurfaceEstimate>(const fractal::HeightSamples&, const fractal::SurfaceRequest&)>;

inline Judgement judge_scattered(const ScatteredTruth& scene, const ScatteredMethod& method,
                                 const fractal::FractalLaw* law = nullptr) {
  using namespace fractal;
  SurfaceRequest request = scene.request;
  if (law != nullptr) request.law.law = *law;
  Grid<float> draw;
  request.on_draw = [&](int, const Grid<float>& drawn) { draw = drawn; };
  Judgement result;
  SurfaceEstimate estimate;
  timespec before{}, after{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &before);
  estimate = *method(scene.samples, request);
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &after);
  result.seconds =
      static_cast<double>(after.tv_sec - before.tv_sec) + 1e-9 * static_cast<double>(after.tv_nsec - before.tv_nsec);
  result.roughness = axis_dimension(draw) - axis_dimension(scene.truth);
  for (int r = 0; r < scene.truth.rows(); ++r)
    for (int c = 0; c < scene.truth.columns(); ++c) {
      if (scene.known(r, c)) continue;
      result.score.add(static_cast<double>(scene.truth(r, c) - estimate.mean_m(r, c)),
                       kEightRealisations * static_cast<double>(estimate.sd_m(r, c)));
      result.draw_square += std::pow(static_cast<double>(scene.truth(r, c) - draw(r, c)), 2);
    }
  return result;
}

struct JudgementColumn {
  Errors roughness, dimension;
  double draw_square = 0.0, seconds = 0.0;
  fractal::PredictionScore score;
  void operator+=(const Judgement& one) {
    roughness.add(one.roughness);
    draw_square += one.draw_square;
    seconds += one.seconds;
    score += one.score;
  }
};

/// The rows that every method's table has.
inline void print_judgement_rows(const std::string& name, const std::vector<JudgementColumn>& columns) {
  const auto row = [&](const std::string& what, auto cell) {
    print_row(name + what, columns.size(), [&](std::size_t c) { return cell(columns[c]); });
  };
  row(": D^ − D*, mean", [](const JudgementColumn& c) { return with_sign(c.roughness.mean(), 3); });
  row(": D^ − D*, worst", [](const JudgementColumn& c) { return with_sign(c.roughness.worst, 3); });
  row(": RMSE of the mean", [](const JudgementColumn& c) { return fixed(c.score.rmse(), 3); });
  row(": RMSE of a draw", [](const JudgementColumn& c) { return fixed(std::sqrt(c.draw_square / c.score.cells), 3); });
  row(": CRPS", [](const JudgementColumn& c) { return fixed(c.score.crps(), 3); });
  row(": 90 % interval covers", [](const JudgementColumn& c) { return fixed(c.score.coverage(), 3); });
  row(": ms a realisation",
      [](const JudgementColumn& c) { return fixed(1e3 * c.seconds / c.roughness.count / 8.0, 1); });
}

}  // namespace scree::bench
