#pragma once
// One sensor as the rest of the program needs it: geometry, mounting, timing, noise, and what is filtered out.

#include <array>
#include <chrono>
#include <cmath>
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
  double angle_rad = 0.0;  ///< standard deviation of a ray's direction about each of two axes; 0 = none told
};

/// Variance of a range along its ray, m²; `quantum_m` is the range of one count.
inline float range_variance_m2(const RangeNoise& noise, float range_m, float quantum_m) {
  const float s0 = static_cast<float>(noise.sigma_m);
  const float s1 = static_cast<float>(noise.sigma_per_m) * range_m;
  const float s2 = static_cast<float>(noise.sigma_per_m2) * range_m * range_m;
  return s0 * s0 + s1 * s1 + s2 * s2 + quantum_m * quantum_m / 12.0F;
}

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

/// What becomes of a pixel before it may be a point. docs/perceptron.md explains every rule and its failure modes.
struct FilterConfig {
  double range_min_m = 0.0;
  double range_max_m = 100.0;
  std::optional<BodyBox> self_mask;
  /// Returns with a reflectance count below this are no returns (sky of a Perceptron). 0 = off. Only where
  /// projection.reflectance_shift says where the reflectance is; the reader of the frames applies it.
  int min_reflectance = 0;
  /// A pixel is speckle when its surface (pixels joined by similar range) has fewer than this many pixels, when it is
  /// joined to fewer than two of its four neighbours, or when it stands alone at a grazing angle. 0 = off. The default
  /// keeps fewer than one uniformly random pixel in 40 frames of 512 × 512 (derivation: docs/perceptron.md).
  int speckle_min_pixels = 12;
  /// Two neighbours are joined when their ranges differ by less than join_m + join_ratio · range, plus the step that
  /// level ground would make between the two rays.
  double join_m = 0.1;
  double join_ratio = 0.03;
  /// Mixed pixels: a return between two surfaces, whose ray meets the local surface at a grazing angle on both sides.
  bool mixed_pixels = true;
  double grazing_rad = 0.07;  ///< rays that meet the chord to a neighbour at less than this are grazing
  PhasePolicy phase = PhasePolicy::resolve;
  int max_wraps = 2;  ///< intervals considered beyond the first
  /// Evidence for the interval of a surface: ground near the robot lies within anchor_height_m plus this slope of the
  /// body frame's plane z = 0; the ground already mapped lies within map_gate_sigmas standard deviations plus
  /// map_gate_m of the returned heights.
  double anchor_slope_rad = 0.35;
  double anchor_height_m = 0.3;
  double map_gate_sigmas = 4.0;
  double map_gate_m = 0.15;
  int anchor_min_pixels = 12;  ///< agreeing pixels without which a surface is not anchored
};

struct SensorConfig {
  ProjectionConfig projection;
  Pose T_body_sensor;
  Duration row_period{0};  ///< row r is taken at frame time + r · row_period
  RangeNoise noise;
  FilterConfig filter;
};

}  // namespace scree
