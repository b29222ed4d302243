#pragma once
// Range frames of a height field, seen by a spherical scanner on a moving body.

#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "drivers/frame/range_frame.hpp"
#include "tests/mapping/support.hpp"

namespace scree::mapping::test {

/// 40 rows from +0.1 to −0.7 rad, 90 columns over ±0.8 rad, 1.5 m above the body's origin, no noise.
class SphericalScanner {
 public:
  SphericalScanner() {
    ProjectionConfig config;
    config.kind = ProjectionKind::spherical;
    config.range_per_count_m = 0.001;
    config.ambiguity_m = 0.0;
    for (int row = 0; row < kRows; ++row) config.row_elevations_rad.push_back(0.1 - 0.8 * row / (kRows - 1));
    for (int column = 0; column < kColumns; ++column)
      config.column_azimuths_rad.push_back(0.8 - 1.6 * column / (kColumns - 1));
    auto sensor = std::make_shared<SensorConfig>();
    sensor->projection = config;
    sensor->T_body_sensor.translation_m = {0.0, 0.0, 1.5};
    sensor->noise.sigma_m = 0.01;
    sensor->filter.range_max_m = 30.0;
    sensor->filter.speckle_min_pixels = 0;
    sensor->filter.mixed_pixels = false;
    sensor_ = sensor;
    projection_ = *make_projection(config, kRows, kColumns);
  }

  /// The body drives on the map's z = 0 plane: every row has its own pose between `from` and `to`.
  RangeFrame frame(const Height& ground, const Pose& from, const Pose& to, std::uint64_t sequence = 0) const {
    RangeFrame out;
    out.projection = projection_;
    out.sensor = sensor_;
    out.sequence = sequence;
    out.time = Time(std::chrono::seconds(sequence));
    out.range_m = Grid<float>(kRows, kColumns, std::numeric_limits<float>::quiet_NaN());
    for (int row = 0; row < kRows; ++row) {
      const double t = static_cast<double>(row) / (kRows - 1);
      Pose pose = from;
      pose.translation_m = (1.0 - t) * from.translation_m + t * to.translation_m;
      out.row_time.push_back(out.time + std::chrono::milliseconds(row));
      out.T_map_body.push_back(pose);
      const Pose T_map_sensor = pose * sensor_->T_body_sensor;
      for (int column = 0; column < kColumns; ++column) {
        const PixelRay ray = pixel_ray(projection_->config, row, column);
        out.range_m(row, column) =
            first_hit(ground, T_map_sensor * ray.origin_m, T_map_sensor.rotation * ray.direction);
      }
    }
    return out;
  }

  static constexpr int kRows = 40;
  static constexpr int kColumns = 90;

 private:
  static float first_hit(const Height& ground, const Eigen::Vector3d& origin, const Eigen::Vector3d& ray) {
    const auto below = [&](double t) {
      const Eigen::Vector3d p = origin + t * ray;
      return p.z() < ground(p.x(), p.y());
    };
    double t = 0.2;
    while (t < 20.0 && !below(t)) t += 0.05;
    if (t >= 20.0) return std::numeric_limits<float>::quiet_NaN();
    double near = t - 0.05, far = t;
    for (int i = 0; i < 24; ++i) (below(0.5 * (near + far)) ? far : near) = 0.5 * (near + far);
    return static_cast<float>(far);
  }

  std::shared_ptr<const SensorConfig> sensor_;
  std::shared_ptr<const Projection> projection_;
};

inline Pose at(double x_m, double y_m, double heading_rad = 0.0) {
  Pose pose;
  pose.translation_m = {x_m, y_m, 0.0};
  pose.rotation = Eigen::Quaterniond(Eigen::AngleAxisd(heading_rad, Eigen::Vector3d::UnitZ()));
  return pose;
}

}  // namespace scree::mapping::test
