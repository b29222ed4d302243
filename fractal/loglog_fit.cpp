#include "fractal/loglog_fit.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <numbers>

namespace scree::fractal {
namespace {

struct Line {
  double slope = 0.0, intercept = 0.0, largest_residual = 0.0;
};

double residual(const LogLogPoint& p, double slope, double intercept) {
  return p.log_change - intercept - slope * p.log_lag;
}

/// Least squares through points [first, last].
template <class Weight>
Line weighted_line(const std::vector<LogLogPoint>& points, int first, int last, const Weight& weight) {
  double total = 0.0, mean_x = 0.0, mean_y = 0.0, sxx = 0.0, sxy = 0.0;
  for (int i = first; i <= last; ++i) {
    const auto& p = points[static_cast<std::size_t>(i)];
    total += weight(p);
    mean_x += weight(p) * p.log_lag;
    mean_y += weight(p) * p.log_change;
  }
  mean_x /= total;
  mean_y /= total;
  for (int i = first; i <= last; ++i) {
    const auto& p = points[static_cast<std::size_t>(i)];
    const double x = p.log_lag - mean_x;
    sxx += weight(p) * x * x;
    sxy += weight(p) * x * (p.log_change - mean_y);
  }
  Line line;
  line.slope = sxy / sxx;
  line.intercept = mean_y - line.slope * mean_x;
  for (int i = first; i <= last; ++i)
    line.largest_residual = std::max(
        line.largest_residual, std::abs(residual(points[static_cast<std::size_t>(i)], line.slope, line.intercept)));
  return line;
}

Line least_squares(const std::vector<LogLogPoint>& points, int first, int last) {
  return weighted_line(points, first, last, [](const LogLogPoint&) { return 1.0; });
}

/// Convex chain of points [first, last]: the upper one for sign +1, the lower one for −1.
std::vector<int> hull(const std::vector<LogLogPoint>& points, int first, int last, double sign) {
  std::vector<int> chain;
  for (int i = first; i <= last; ++i) {
    const auto& p = points[static_cast<std::size_t>(i)];
    while (chain.size() >= 2) {
      const auto& a = points[static_cast<std::size_t>(chain[chain.size() - 2])];
      const auto& b = points[static_cast<std::size_t>(chain.back())];
      const double turn = (b.log_lag - a.log_lag) * (p.log_change - a.log_change) -
                          (b.log_change - a.log_change) * (p.log_lag - a.log_lag);
      if (sign * turn < 0.0) break;
      chain.pop_back();
    }
    chain.push_back(i);
  }
  return chain;
}

/// The line with the smallest largest vertical distance. It is parallel to an edge of the hull: the strip between that
/// edge and the farthest point of the other chain.
Line minimax(const std::vector<LogLogPoint>& points, int first, int last) {
  Line best;
  best.largest_residual = std::numeric_limits<double>::infinity();
  for (const double sign : {1.0, -1.0}) {
    const std::vector<int> chain = hull(points, first, last, sign);
    for (std::size_t edge = 0; edge + 1 < chain.size(); ++edge) {
      const auto& a = points[static_cast<std::size_t>(chain[edge])];
      const auto& b = points[static_cast<std::size_t>(chain[edge + 1])];
      const double slope = (b.log_change - a.log_change) / (b.log_lag - a.log_lag);
      const double height = a.log_change - slope * a.log_lag;
      double farthest = 0.0;  // on the far side of the edge
      for (int i = first; i <= last; ++i)
        farthest = std::max(farthest, -sign * residual(points[static_cast<std::size_t>(i)], slope, height));
      if (0.5 * farthest < best.largest_residual) best = {slope, height - 0.5 * sign * farthest, 0.5 * farthest};
    }
  }
  return best;
}

/// The longest run from `first` whose line, made by `fit`, stays within the tolerance.
template <class Fit>
LogLogSegment longest_run(const std::vector<LogLogPoint>& points, int first, double tolerance, const Fit& fit) {
  int last = first + 1;
  Line line = fit(points, first, last);
  while (last + 1 < static_cast<int>(points.size())) {
    const Line longer = fit(points, first, last + 1);
    if (longer.largest_residual > tolerance) break;
    line = longer;
    ++last;
  }
  return {first, last, line.slope, line.intercept, line.largest_residual};
}

LogLogDimension described(const std::vector<LogLogPoint>& points, const LogLogSegment& segment, Moment moment,
                          LineWeights weights) {
  // Relative to the first distance: no weight vanishes or grows without bound.
  const double origin = points[static_cast<std::size_t>(segment.first)].log_lag;
  const double power = weights == LineWeights::inverse_square ? -2.0 : 0.0;
  const Line line = weighted_line(points, segment.first, segment.last,
                                  [&](const LogLogPoint& p) { return std::exp(power * (p.log_lag - origin)); });
  LogLogDimension result;
  result.dimension = 3.0 - line.slope;
  // E|z| = σ·√(2/π) for Gaussian differences
  result.amplitude_m =
      std::exp(line.intercept) * (moment == Moment::first_absolute ? std::sqrt(std::numbers::pi / 2.0) : 1.0);
  result.lag_min_m = std::exp(points[static_cast<std::size_t>(segment.first)].log_lag);
  result.lag_max_m = std::exp(points[static_cast<std::size_t>(segment.last)].log_lag);
  result.points = segment.last - segment.first + 1;
  return result;
}

}  // namespace

std::vector<LogLogPoint> log_log_points(const StructureFunction& statistics, Moment moment, double min_pairs) {
  std::vector<LogLogPoint> points;
  if (moment == Moment::first_absolute && !statistics.has_absolute) return points;
  for (const PairSums& sums : statistics.sums) {
    if (sums.count < std::max(1.0, min_pairs)) continue;
    const double change =
        moment == Moment::first_absolute ? sums.abs_m / sums.count : std::sqrt(sums.square_m2 / sums.count);
    if (change > 0.0) points.push_back({sums.log_m / sums.count, std::log(change), sums.count});
  }
  return points;
}

std::vector<LogLogSegment> linear_segments(const std::vector<LogLogPoint>& points, Segmentation segmentation,
                                           double tolerance) {
  std::vector<LogLogSegment> segments;
  const int count = static_cast<int>(points.size());
  if (count < 2) return segments;
  if (segmentation == Segmentation::least_squares) {
    segments.push_back(longest_run(points, 0, tolerance, least_squares));
    return segments;
  }
  for (int first = 0; first + 1 < count; first = segments.back().last)
    segments.push_back(longest_run(points, first, tolerance, minimax));
  return segments;
}

Result<LogLogDimension> log_log_dimension(const std::vector<LogLogPoint>& points, Moment moment,
                                          Segmentation segmentation, double tolerance, LineWeights weights) {
  std::vector<LogLogSegment> segments;
  if (segmentation == Segmentation::polyline) {
    segments = linear_segments(points, segmentation, tolerance);
  } else {
    for (int first = 0; first + 2 < static_cast<int>(points.size()); ++first) {
      segments = {longest_run(points, first, tolerance, least_squares)};
      if (segments[0].last - first >= 2) break;
    }
  }
  for (const LogLogSegment& segment : segments) {
    if (segment.last - segment.first < 2) continue;
    LogLogDimension result = described(points, segment, moment, weights);
    result.segments = std::move(segments);
    return result;
  }
  return Error{ErrorKind::bad_data,
               fmt::format("log-log plot: expected a linear part of at least 3 of its points within a tolerance of {}, "
                           "found none among {} points",
                           tolerance, points.size())};
}

}  // namespace scree::fractal
