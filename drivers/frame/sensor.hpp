#pragma once
// One sensor as the rest of the program needs it: geometry, mounting, timing, noise, and what is filtered out.

#include <array>
#include <chrono>
#include <optional>

#include "core/pose.hpp"
#include "core/time.hpp"
#include "drivers/frame/projection.hpp"

namespace scree {

/// Standard deviation of a range: sqrt(sigma_m² + (sigma_per_m·ρ)² + (sigma_per_m2·ρ²)² + quantum²/12), metres.
struct RangeNoise {
  double sigma_m = 0.02;
  double sigma_per_m = 0.0;
  double sigma_per_m2 = 0.0;
};

/// Axis-aligned box in the body frame, metres; returns inside are the robot itself.
struct BodyBox {
  Eigen::Vector3d min_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d max_m = Eigen::Vector3d::Zero();
};

/// How a range of an ambiguous sensor gets its interval.
enum class PhasePolicy : std::uint8_t {
  resolve,         ///< unwrap against neighbours, anchor on the ground or the map; drop and count the rest
  first_interval,  ///< as resolve, but a frame without any anchor takes its largest surface to be in the first
                   ///< interval: for files without extrinsics or pose, and said in a warning
};

struct FilterConfig {
  double range_min_m = 0.0;
  double range_max_m = 100.0;
  std::optional<BodyBox> self_mask;
  /// A pixel is speckle when its surface (pixels joined by similar range) has fewer than this many pixels. 0 = off.
  int speckle_min_pixels = 12;
  /// Two neighbours are joined when their ranges differ by less than join_m + join_ratio · range.
  double join_m = 0.1;
  double join_ratio = 0.03;
  /// Mixed pixels: a return between two surfaces, whose ray meets the local surface at a grazing angle on both sides.
  bool mixed_pixels = true;
  PhasePolicy phase = PhasePolicy::resolve;
  int max_wraps = 2;  ///< intervals considered beyond the first
};

struct SensorConfig {
  ProjectionConfig projection;
  Pose T_body_sensor;
  Duration row_period{0};  ///< row r is taken at frame time + r · row_period
  RangeNoise noise;
  FilterConfig filter;
};

}  // namespace scree
