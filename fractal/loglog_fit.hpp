#pragma once
// From pair statistics to D: the log–log plot of [AK96] section 2.4, its linear parts, and the slope of the first.

#include <vector>

#include "core/result.hpp"
#include "fractal/structure_function.hpp"

namespace scree::fractal {

enum class Moment {
  first_absolute,  ///< E|z − z'|: Yokoya [Y89]
  second,          ///< √E(z − z')²: Pentland [P84]
};

/// One annulus in the plot, natural logarithms of metres.
struct LogLogPoint {
  double log_lag = 0.0;  ///< mean over the pairs that fell in, not ln d_i (which biases D by up to 3 %)
  double log_change = 0.0;
  double pairs = 0.0;
};

/// Annuli with at least `min_pairs` pairs and a change above 0, in order of distance. Empty where the route has no
/// Σ|z − z'| and the moment needs it.
std::vector<LogLogPoint> log_log_points(const StructureFunction& statistics, Moment moment, double min_pairs = 30);

enum class Segmentation {
  polyline,       ///< minimax: greedily the longest runs within a band of ± tolerance [AK96], after Kurozumi
  least_squares,  ///< the longest first run whose least-squares line is within ± tolerance of every point
};

/// Points [first, last] of the plot and their line: log_change = intercept + slope·log_lag.
struct LogLogSegment {
  int first = 0, last = 0;
  double slope = 0.0;
  double intercept = 0.0;
  double largest_residual = 0.0;
};

/// Polyline: consecutive segments share their end points and cover the plot; lines are the minimax (Chebyshev) lines.
/// Least squares: only the first linear part. `tolerance` in nepers. Fewer than 2 points: none. Cost: O(n²).
std::vector<LogLogSegment> linear_segments(const std::vector<LogLogPoint>& points, Segmentation segmentation,
                                           double tolerance);

/// How annuli count in the line through the part that was found.
enum class LineWeights {
  equal,           ///< the paper's
  inverse_square,  ///< 1/distance²: as many independent patches of ground there are; for geometric annuli
};

struct LogLogDimension {
  double dimension = 0.0;    ///< 3 − slope of the first linear part (least squares); not clipped to [2, 3]
  double amplitude_m = 0.0;  ///< rms change at 1 m that the line gives; Gaussian heights assumed for the first moment
  double lag_min_m = 0.0;    ///< the range of scales of that part: mean distances of its first and last annulus
  double lag_max_m = 0.0;
  int points = 0;                       ///< annuli in it
  std::vector<LogLogSegment> segments;  ///< all that were found, the first is the one used
};

/// Parts of fewer than 3 points have no line worth the name and are passed over; the least-squares segmentation starts
/// again behind them. Errors: bad_data (no part of at least 3 points).
Result<LogLogDimension> log_log_dimension(const std::vector<LogLogPoint>& points, Moment moment,
                                          Segmentation segmentation, double tolerance = 0.05,
                                          LineWeights weights = LineWeights::equal);

}  // namespace scree::fractal
