#pragma once
// A survey made ready for the likelihood: checked, merged, levelled, in natural units and in random order.

#include <vector>

#include "core/result.hpp"
#include "fractal/dimension_estimate.hpp"

namespace scree::fractal {

/// Lengths in mean spacings, heights above the least-squares plane in units of their own rms.
struct VecchiaPoint {
  double x, y, z;
  double noise_share;  ///< noise variance relative to that of a single point: 1/n for the mean of n at one place
};

struct VecchiaPoints {
  std::vector<VecchiaPoint> points;  ///< no two at one place; random order, the same for the same survey
  double spacing_m = 1.0;
  double height_m = 1.0;        ///< unit of z
  double noise_variance = 0.0;  ///< in units of height_m²; 0 where unknown
  bool noise_unknown = false;
  std::size_t duplicates = 0;
  double slope_x = 0.0, slope_y = 0.0;  ///< metres a metre of the plane that was taken off
};

/// Errors: those of estimate_dimension_vecchia. Cost: O(N log N).
Result<VecchiaPoints> prepare_points(const SurveyPoints& survey);

/// The box that holds most points, from the 10 % and 90 % quantiles of each coordinate stretched by a quarter: that of
/// uniformly spread points is theirs, and a few far away do not matter.
struct Box {
  double x_min = 0.0, x_max = 0.0, y_min = 0.0, y_max = 0.0;
};
Box main_box(const std::vector<VecchiaPoint>& points);

}  // namespace scree::fractal
