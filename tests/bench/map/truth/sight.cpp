#include "tests/bench/map/truth/sight.hpp"

#include <cmath>

namespace scree::bench {
namespace {

constexpr double kBefore_m = 0.05;

}  // namespace

Sight::Sight(const drivers::Simulator& simulator)
    : simulator_(simulator),
      spherical_(simulator.description().sensor.projection.kind == ProjectionKind::spherical),
      range_m_(simulator.description().sensor.filter.range_max_m),
      low_rad_(Eigen::Vector2d::Constant(1e9)),
      high_rad_(-low_rad_) {
  const SensorConfig& sensor = simulator.description().sensor;
  const ProjectionConfig& projection = sensor.projection;
  for (int r = 0; r < projection.rows; ++r)
    for (int c = 0; c < projection.columns; ++c) {
      const Eigen::Vector2d view = angles(pixel_ray(projection, r, c).direction);
      low_rad_ = low_rad_.cwiseMin(view);
      high_rad_ = high_rad_.cwiseMax(view);
    }
  for (std::size_t i = 0; i < simulator.frame_count(); ++i) {
    const Time middle = simulator.frame_time(i) + sensor.row_period * (projection.rows / 2);
    const auto body = simulator.poses().at(middle);
    T_map_sensor_.push_back(body.value_or(simulator.poses().poses().back().T_map_body) * sensor.T_body_sensor);
  }
}

bool Sight::open(const Eigen::Vector3d& point_map_m) const {
  for (const Pose& T_map_sensor : T_map_sensor_) {
    if (!in_view(T_map_sensor.inverse() * point_map_m)) continue;
    const Eigen::Vector3d ray = point_map_m - T_map_sensor.translation_m;
    const double length_m = ray.norm();
    const auto hit = simulator_.terrain().cast(T_map_sensor.translation_m, ray / length_m, length_m);
    if (hit.kind == drivers::TerrainHit::Kind::nothing || hit.distance_m > length_m - kBefore_m) return true;
  }
  return false;
}

bool Sight::in_view(const Eigen::Vector3d& point_sensor_m) const {
  const Eigen::Vector2d view = angles(point_sensor_m);
  return point_sensor_m.norm() < range_m_ && (view.array() >= low_rad_.array()).all() &&
         (view.array() <= high_rad_.array()).all();
}

Eigen::Vector2d Sight::angles(const Eigen::Vector3d& d) const {
  if (spherical_) return {std::atan2(d.y(), d.x()), std::atan2(d.z(), std::hypot(d.x(), d.y()))};
  return {std::atan2(d.x(), d.z()), std::atan2(d.y(), d.z())};
}

}  // namespace scree::bench
