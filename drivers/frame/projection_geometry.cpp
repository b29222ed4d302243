// The published geometry of each projection, in double: one function a kind.

#include <cmath>
#include <numbers>

#include "drivers/frame/projection.hpp"

namespace scree {
namespace {

// USF constants [HJ96], in the set's own length unit; the mirrors slope at gamma = theta = 45°, alpha0 = beta0 = 0.
constexpr double kBeamToRotatingAxis = 3.0;  // h1
constexpr double kNoddingAxisToBeam = 5.5;   // h2
constexpr double kMirrorSlope_rad = std::numbers::pi / 4.0;
constexpr double kStandoffCounts = 830.3;  // r0

/// Scan angle of pixel `index` of `count`: symmetric about the image centre, positive towards index 0.
double scan_angle_rad(double field_rad, int index, int count) {
  return field_rad * ((count - 1) / 2.0 - index) / count;
}

/// Perceptron axes: x left (alpha), y up (beta), z out.
Eigen::Vector3d perceptron_direction(double alpha, double beta) {
  return {std::sin(alpha), std::cos(alpha) * std::sin(beta), std::cos(alpha) * std::cos(beta)};
}

/// The beam turns on two sloping mirrors, so its exit point wanders with the scan angles and the path inside the
/// scanner (r1 + r2 counts) is part of the measured one.
PixelRay usf_ray(const ProjectionConfig& config, double alpha, double beta) {
  const double dz = -kBeamToRotatingAxis * (1.0 - std::cos(alpha)) / std::tan(kMirrorSlope_rad);
  const double dy = dz * std::tan(kMirrorSlope_rad + beta / 2.0);
  const double dx = (kNoddingAxisToBeam + dy) * std::tan(alpha);
  const double inner_path = (dz - kNoddingAxisToBeam) + std::hypot(dx, kNoddingAxisToBeam + dy);  // (r1 + r2)·delta
  PixelRay ray;
  ray.origin_m = Eigen::Vector3d(dx, dy, dz) * config.unit_m;
  ray.direction = perceptron_direction(alpha, beta);
  ray.range_per_count_m = config.range_per_count_m;
  ray.range_offset_m = kStandoffCounts * config.range_per_count_m - inner_path * config.unit_m + config.range_offset_m;
  return ray;
}

PixelRay polar_ray(const ProjectionConfig& config, const Eigen::Vector3d& direction) {
  return {Eigen::Vector3d::Zero(), direction, config.range_offset_m, config.range_per_count_m};
}

/// A depth image holds z; along the ray that is z · |(u, v, 1)|.
PixelRay pinhole_ray(const ProjectionConfig& config, int row, int column) {
  const Eigen::Vector3d at_unit_depth((column - config.cx_px) / config.fx_px, (row - config.cy_px) / config.fy_px, 1.0);
  const double length = at_unit_depth.norm();
  return {Eigen::Vector3d::Zero(), at_unit_depth / length, 0.0, config.depth_unit_m * length};
}

PixelRay spherical_ray(const ProjectionConfig& config, int row, int column) {
  const double elevation = config.row_elevations_rad[static_cast<std::size_t>(row)];
  const double azimuth = config.column_azimuths_rad[static_cast<std::size_t>(column)];
  return polar_ray(
      config, {std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth), std::sin(elevation)});
}

}  // namespace

PixelRay pixel_ray(const ProjectionConfig& config, int row, int column) {
  const double alpha = scan_angle_rad(config.field_of_view_rad[0], column, config.columns);
  const double beta = scan_angle_rad(config.field_of_view_rad[1], row, config.rows);
  switch (config.kind) {
    case ProjectionKind::perceptron_usf:
      return usf_ray(config, alpha, beta);
    case ProjectionKind::perceptron_cmu:
      return polar_ray(config, perceptron_direction(alpha, beta));
    case ProjectionKind::spherical:
      return spherical_ray(config, row, column);
    case ProjectionKind::pinhole:
      return pinhole_ray(config, row, column);
    case ProjectionKind::cloud:
      break;
  }
  return {};
}

std::uint16_t wrapped_count(double count, int interval_counts) {
  const long long remainder = std::llround(count) % interval_counts;
  return static_cast<std::uint16_t>(remainder < 0 ? remainder + interval_counts : remainder);
}

}  // namespace scree
