#pragma once
// The structure function of a survey above its least-squares plane, and the geometry that its errors depend on.

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/executor.hpp"
#include "core/result.hpp"
#include "fractal/dimension_estimate.hpp"

namespace scree::fractal {

/// One annulus that holds pairs. Lengths in mean spacings, heights in units of LagStatistics::height_m.
struct Lag {
  double inner = 0.0, outer = 0.0;
  double distance = 0.0;    ///< geometric mean over its pairs
  double spread = 0.0;      ///< standard deviation of their log distances
  double log_square = 0.0;  ///< ln of the mean-square height change, the plane taken off
  double pairs = 0.0;
  double points = 0.0;  ///< that were looked at for it: fewer than all at long lags of large surveys
};

struct LagStatistics {
  std::vector<Lag> lags;  ///< ascending
  double spacing_m = 1.0, height_m = 1.0;
  double side = 1.0;            ///< √ of the area the points cover, spacings
  double cell = 0.0;            ///< pitch of the square lattice the points lie on, spacings; 0: scattered
  double fill = 0.0;            ///< share of lattice cells that are known where any are; 0: scattered
  double noise_variance = 0.0;  ///< known, of a height
  double slope_noise = 0.0;     ///< variance that horizontal noise makes of the slope of the least-squares plane
  double blur = 0.0;            ///< horizontal noise, spacings
  std::size_t points = 0, duplicates = 0;
  /// For what depends on the shape of the survey: one point (x, y) out of each of at most 576 squares, and how many
  /// points it stands for.
  Eigen::MatrixX2d sample;
  Eigen::VectorXd sample_weights;
};

struct LagOptions {
  double max_lag_m = 0.0;  ///< 0: .225 √area, beyond which a survey knows little; 2.5 spacings at least
  std::uint64_t seed = 1;  ///< which points stand for all at long lags of large surveys
};

/// About twenty annuli, evenly spaced in log distance from a quarter spacing (scattered) or one cell (lattice). All
/// pairs where these are few, by Fourier transforms on lattices, else thinned out with distance: below .1 s for 65,536
/// points. Errors, bad_data: those of prepare_points, a longest lag that is not positive or leaves fewer than four
/// annuli.
Result<LagStatistics> lag_statistics(const SurveyPoints& survey, const LagOptions& options, Executor& executor);

}  // namespace scree::fractal
