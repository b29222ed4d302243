#pragma once
// What an estimator of D says about one set of points, whatever its method.

#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace scree::fractal {

/// A survey: three spans of one length, metres, horizontal plane and height. What the noise of a height is should be
/// known from the sensor: it cannot be had from fewer than a thousand points, and D depends on it.
struct SurveyPoints {
  std::span<const double> x_m, y_m, z_m;
  double noise_sigma_m = 0.0;        ///< of each height, independent
  double noise_xy_sigma_m = 0.0;     ///< of each horizontal coordinate
  double height_resolution_m = 0.0;  ///< rounding of the heights: what lies on a plane to within this has no D
  bool noise_unknown = false;        ///< estimate it beside D, from kMinNoisePoints at least; noise_sigma_m stays 0
};

enum EstimateFlag : std::uint16_t {
  /// The noise variance exceeds the squared height change over the mean spacing (τ > 1), or hides all of it: D = NaN.
  kNoiseHides = 1,
  /// The interval is open below: 2 ≤ D is all that the data say there.
  kOpenBelow = 2,
  /// The interval is open above: D ≤ 3.
  kOpenAbove = 4,
  /// Points at one place were averaged. Without noise in the model their heights contradict it, if they differ.
  kDuplicatesMerged = 8,
  /// Horizontal noise of .3 mean spacings or more: the slopes of the ground turn it into vertical noise that no
  /// likelihood here models, and D is too large, most of all for smooth ground.
  kHorizontalNoise = 16,
  /// A random part of the points, whose neighbours stand at least twice as far apart, has another D (beyond 3.3
  /// standard deviations): not one power law over these scales, or interpolated, or rounded data, or a wrong noise.
  kScaleDependent = 32,
};

/// "noise_limited", "open_below", …: in the order of the bits.
std::vector<std::string_view> flag_names(std::uint16_t flags);

struct Interval {
  double low = 2.0, high = 3.0;
};

/// D, its interval, and the amplitude that belongs to it (docs/fractal.md).
struct DimensionEstimate {
  double dimension = std::numeric_limits<double>::quiet_NaN();
  Interval interval95;                                            ///< of D; 2 and 3 stand for an open side
  double sigma = std::numeric_limits<double>::quiet_NaN();        ///< one standard deviation of D, within its bounds
  double amplitude_m = std::numeric_limits<double>::quiet_NaN();  ///< rms height change between points 1 m apart
  std::string method;
  std::size_t points = 0;        ///< at different places: what the estimate rests on
  std::size_t duplicates = 0;    ///< averaged into the others
  double spacing_m = 0.0;        ///< mean spacing
  double noise_sigma_m = 0.0;    ///< used: vertical, and horizontal through the slope of the plane
  bool noise_estimated = false;  ///< then noise_sigma_m is an estimate and the interval of D allows for its error
  double coarse_dimension = std::numeric_limits<double>::quiet_NaN();  ///< of a random part; NaN for few points
  double coarse_spacing_m = 0.0;                                       ///< its mean spacing
  /// −2 log of the restricted likelihood at its best, up to a constant of the points alone: comparable between noises.
  /// NaN for methods without one.
  double minus_two_log = std::numeric_limits<double>::quiet_NaN();
  double relative_noise = 0.0;  ///< τ: noise variance over the squared height change at the mean spacing
  /// The range of scales the estimate rests on: distances between points. NaN where the method does not say.
  double lag_min_m = std::numeric_limits<double>::quiet_NaN();
  double lag_max_m = std::numeric_limits<double>::quiet_NaN();
  std::uint16_t flags = 0;
};

inline constexpr std::size_t kMinSurveyPoints = 20;
inline constexpr std::size_t kMinNoisePoints = 1000;  ///< places needed to estimate the noise from the heights

}  // namespace scree::fractal
