#pragma once
// Surveys for judging estimators of D: some cells of an exact surface, and those of the experiment of [AK96]
// section 2.5.

#include <cmath>
#include <cstdint>
#include <vector>

#include "core/grid.hpp"
#include "core/random.hpp"
#include "fractal/dimension_estimate.hpp"
#include "fractal/loglog_fit.hpp"
#include "fractal/structure_function.hpp"
#include "fractal/surface.hpp"

namespace scree::fractal {

struct Survey {
  std::vector<double> x, y, z;
  SurveyPoints points(double noise = 0.0, double noise_xy = 0.0) const {
    return {.x_m = x, .y_m = y, .z_m = z, .noise_sigma_m = noise, .noise_xy_sigma_m = noise_xy};
  }
  PointColumns columns() const {
    PointColumns out;
    for (std::size_t i = 0; i < z.size(); ++i)
      out.push_back(static_cast<float>(x[i]), static_cast<float>(y[i]), static_cast<float>(z[i]));
    return out;
  }
};

/// Exactly `count` random cells of a surface with their places in units of `cell`.
inline Survey some_cells(const Grid<float>& surface, std::size_t count, double cell, std::uint64_t seed) {
  Survey survey;
  std::size_t wanted = count, left = surface.size();
  for (int r = 0; r < surface.rows(); ++r)
    for (int c = 0; c < surface.columns(); ++c, --left) {
      if (to_uniform(random_words(seed, 5, c, r)[0]) * static_cast<double>(left) >= static_cast<double>(wanted))
        continue;
      --wanted;
      survey.x.push_back(cell * c);
      survey.y.push_back(cell * r);
      survey.z.push_back(surface(r, c));
    }
  return survey;
}

inline void add_plane(Survey& survey, double slope_x, double slope_y) {
  for (std::size_t i = 0; i < survey.z.size(); ++i) survey.z[i] += slope_x * survey.x[i] + slope_y * survey.y[i];
}

/// Independent normal noise of the heights and of both horizontal coordinates.
inline void add_noise(Survey& survey, double sigma, double sigma_xy, std::uint64_t seed) {
  for (std::size_t i = 0; i < survey.z.size(); ++i) {
    const auto at = static_cast<std::int32_t>(i);
    survey.z[i] += sigma * random_normals(seed, 6, at, 0)[0];
    const auto across = random_normals(seed, 7, at, 0);
    survey.x[i] += sigma_xy * across[0];
    survey.y[i] += sigma_xy * across[1];
  }
}

/// 3277 of the 65536 cells of 256 × 256: 5 %.
inline constexpr std::size_t kPaperPoints = 3277;
inline constexpr int kPaperSide = 256;

/// Exact ground; unit of length: the mean spacing; of height: the rms change over it.
inline Survey exact_survey(double dimension, std::uint64_t seed, std::size_t count = kPaperPoints) {
  const double cell = std::sqrt(static_cast<double>(count)) / kPaperSide;
  return some_cells(*fbm_surface({dimension, 1.0}, kPaperSide, kPaperSide, cell, seed), count, cell, seed);
}

/// As the paper has it: unit of length one cell, heights with the standard deviation of the horizontal coordinates.
inline Survey paper_survey(const Grid<float>& surface, std::uint64_t seed) {
  Survey survey = some_cells(surface, kPaperPoints, 1.0, seed);
  double sum = 0.0, sum2 = 0.0;
  for (const double z : survey.z) sum += z, sum2 += z * z;
  const double n = static_cast<double>(survey.z.size()), side = surface.rows();
  const double sigma_z = std::sqrt(sum2 / n - sum * sum / n / n), sigma_x = std::sqrt((side * side - 1.0) / 12.0);
  for (double& z : survey.z) z *= sigma_x / sigma_z;
  return survey;
}

/// First absolute moments in annuli and one unweighted line through all of them.
inline double first_moment_dimension(const Survey& survey, const Annuli& annuli, const PairOptions& options = {}) {
  SerialExecutor serial;
  const auto statistics = *structure_function(survey.columns(), annuli, options, serial);
  constexpr double kAnything = 1e3;  // bounds no line
  return log_log_dimension(log_log_points(statistics, Moment::first_absolute), Moment::first_absolute,
                           Segmentation::least_squares, kAnything)
      ->dimension;
}

/// The paper's estimate from a survey in cells: first absolute moments of all pairs 10 … last_lag cells apart, in
/// annuli a cell wide, and the iterative line.
inline double papers_estimate(const Survey& survey, int last_lag = 60) {
  Annuli annuli = uniform_annuli(1.0, last_lag);
  annuli.first_m = 10.0;
  annuli.count = last_lag - 9;
  return first_moment_dimension(survey, annuli);
}

/// The standard deviation of noise that is `snr_db` below coordinates of a square of kPaperSide cells.
inline double paper_noise(double snr_db) {
  return std::sqrt((kPaperSide * kPaperSide - 1.0) / 12.0) * std::pow(10.0, -snr_db / 20.0);
}

}  // namespace scree::fractal
