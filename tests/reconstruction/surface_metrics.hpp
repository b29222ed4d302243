#pragma once
// How good a reconstruction is: the figures that the tests and the benches agree on.

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "core/grid.hpp"
#include "fractal/axis_dimension.hpp"

namespace scree::fractal {

/// rms height change over `lag` cells along the axes.
inline double rms_increment(const Grid<float>& z, int lag) {
  double sum = 0;
  long n = 0;
  for (int r = 0; r < z.rows(); ++r)
    for (int c = 0; c < z.columns(); ++c) {
      if (c + lag < z.columns()) sum += std::pow(static_cast<double>(z(r, c + lag) - z(r, c)), 2), ++n;
      if (r + lag < z.rows()) sum += std::pow(static_cast<double>(z(r + lag, c) - z(r, c)), 2), ++n;
    }
  return std::sqrt(sum / static_cast<double>(n));
}

/// Exponent of the rms increments between two lags: H where the surface is one of that law.
inline double increment_slope(const Grid<float>& z, int lag, int longer) {
  return std::log(rms_increment(z, longer) / rms_increment(z, lag)) / std::log(static_cast<double>(longer) / lag);
}

/// Continuous ranked probability score of the prediction N(mean, sd²), `error` = truth − mean [GR07].
inline double gaussian_crps(double error, double sd) {
  if (!(sd > 0.0)) return std::abs(error);
  const double s = error / sd;
  const double density = std::exp(-0.5 * s * s) / std::sqrt(2.0 * std::numbers::pi);
  return sd * (s * std::erf(s / std::numbers::sqrt2) + 2.0 * density - 1.0 / std::sqrt(std::numbers::pi));
}

inline constexpr double kNormal95 = 1.6448536;  ///< half-width of a 90 % interval in standard deviations

/// Of predictions of cells that were held out; add() them, ask at the end. In the unit that the errors come in.
struct PredictionScore {
  double square = 0.0, crps_sum = 0.0, covered = 0.0, normalised = 0.0;
  double cells = 0.0;

  void add(double error, double sd) {
    square += error * error;
    crps_sum += gaussian_crps(error, sd);
    covered += std::abs(error) < kNormal95 * sd ? 1.0 : 0.0;
    normalised += error * error / (sd * sd);
    cells += 1.0;
  }
  PredictionScore& operator+=(const PredictionScore& other) {
    square += other.square, crps_sum += other.crps_sum, covered += other.covered;
    normalised += other.normalised, cells += other.cells;
    return *this;
  }
  double rmse() const { return std::sqrt(square / cells); }
  double crps() const { return crps_sum / cells; }
  double coverage() const { return covered / cells; }
};

/// Scores of the cells for which `wanted(row, column)` holds; errors in units of `unit_m`.
template <class Wanted>
PredictionScore score_prediction(const Grid<float>& truth_m, const Grid<float>& mean_m, const Grid<float>& sd_m,
                                 double unit_m, const Wanted& wanted) {
  PredictionScore score;
  for (int r = 0; r < truth_m.rows(); ++r)
    for (int c = 0; c < truth_m.columns(); ++c)
      if (wanted(r, c))
        score.add(static_cast<double>(truth_m(r, c) - mean_m(r, c)) / unit_m, static_cast<double>(sd_m(r, c)) / unit_m);
  return score;
}

/// Exact Euclidean distance of each cell from the nearest one that is not NaN, in cells (∞ without any). Plain: along
/// the rows, then the best of each column; O(cells · rows).
inline Grid<float> distance_to_data(const Grid<float>& height) {
  constexpr int kFar = 1 << 20;
  Grid<int> along(height.rows(), height.columns(), kFar);
  for (int r = 0; r < height.rows(); ++r) {
    for (int c = 0, last = -kFar; c < height.columns(); ++c) {
      if (!std::isnan(height(r, c))) last = c;
      along(r, c) = c - last;
    }
    for (int c = height.columns(), last = kFar + c; c-- > 0;) {
      if (!std::isnan(height(r, c))) last = c;
      along(r, c) = std::min(along(r, c), last - c);
    }
  }
  Grid<float> distance(height.rows(), height.columns(), std::numeric_limits<float>::infinity());
  for (int c = 0; c < height.columns(); ++c)
    for (int r = 0; r < height.rows(); ++r) {
      double best = along(r, c) < kFar ? static_cast<double>(along(r, c)) * along(r, c) : 1e30;
      for (int away = 1; static_cast<double>(away) * away < best; ++away) {
        if (r - away < 0 && r + away >= height.rows()) break;
        for (const int row : {r - away, r + away})
          if (row >= 0 && row < height.rows() && along(row, c) < kFar)
            best =
                std::min(best, static_cast<double>(along(row, c)) * along(row, c) + static_cast<double>(away) * away);
      }
      if (best < 1e30) distance(r, c) = static_cast<float>(std::sqrt(best));
    }
  return distance;
}

}  // namespace scree::fractal
