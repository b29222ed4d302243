#pragma once
// Analytic scenes seen through a projection: exact ray casting in double, then the sensor's counts.

#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <optional>

#include "core/random.hpp"
#include "drivers/frame/point_frame.hpp"
#include "drivers/frame/pose_track.hpp"

namespace scree::test {

/// Distance along a ray of the map frame to the nearest surface; nothing = sky.
using Scene = std::function<std::optional<double>(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction)>;

/// The plane through `point` with `normal`, where the ray meets it from either side.
inline Scene plane(const Eigen::Vector3d& point, const Eigen::Vector3d& normal) {
  return [=](const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) -> std::optional<double> {
    const double speed = direction.dot(normal);
    const double range = (point - origin).dot(normal) / speed;
    return speed != 0.0 && range > 0.0 ? std::optional(range) : std::nullopt;
  };
}

/// `scene` where `inside` holds of the point met.
inline Scene part(Scene scene, std::function<bool(const Eigen::Vector3d&)> inside) {
  return [=](const Eigen::Vector3d& o, const Eigen::Vector3d& d) -> std::optional<double> {
    const auto range = scene(o, d);
    return range && inside(o + *range * d) ? range : std::nullopt;
  };
}

inline Scene nearest(Scene a, Scene b) {
  return [=](const Eigen::Vector3d& o, const Eigen::Vector3d& d) -> std::optional<double> {
    const auto first = a(o, d);
    const auto second = b(o, d);
    return first && second ? std::min(*first, *second) : (first ? first : second);
  };
}

/// Rough ground, zero below the robot: 48 sinusoids whose wavelengths run from 0.1 to 10 m and whose amplitudes fall as
/// frequency^−1.5 (H = 0.5), scaled to `rms_1m` metres of height change between points 1 m apart.
class RoughGround {
 public:
  RoughGround(double rms_1m, std::uint64_t seed) {
    double change2 = 0.0;
    for (int i = 0; i < kWaves; ++i) {
      const auto words = random_words(seed, 2, i, 0);
      const double frequency = 0.1 * std::pow(100.0, (i + 0.5) / kWaves);
      const double angle = 6.2832 * to_uniform(words[0]);
      Wave& wave = waves_[static_cast<std::size_t>(i)];
      wave.kx = 6.2832 * frequency * std::cos(angle);
      wave.ky = 6.2832 * frequency * std::sin(angle);
      wave.phase = 6.2832 * to_uniform(words[1]);
      wave.amplitude = std::pow(frequency, -0.5);  // log-spaced waves: spectral density f^-2
      change2 += wave.amplitude * wave.amplitude * (1.0 - std::cos(6.2832 * frequency * 0.7));
    }
    for (auto& wave : waves_) wave.amplitude *= rms_1m / std::sqrt(change2);
    offset_ = height(0.0, 0.0);
  }
  double height(double x, double y) const {
    double z = -offset_;
    for (const auto& wave : waves_) z += wave.amplitude * std::sin(wave.kx * x + wave.ky * y + wave.phase);
    return z;
  }
  /// Marches in steps of a quarter of the shortest wave's height over the ground, then bisects to 0.1 mm.
  std::optional<double> operator()(const Eigen::Vector3d& o, const Eigen::Vector3d& d) const {
    const auto clearance = [&](double t) { return o.z() + t * d.z() - height(o.x() + t * d.x(), o.y() + t * d.y()); };
    double before = 0.3;
    double above = clearance(before);
    while (before < 60.0) {
      const double after = before + std::max(0.02, 0.3 * above);
      above = clearance(after);
      if (above <= 0.0) {
        double low = before;
        double high = after;
        while (high - low > 1e-4) (clearance(0.5 * (low + high)) > 0.0 ? low : high) = 0.5 * (low + high);
        return 0.5 * (low + high);
      }
      before = after;
    }
    return std::nullopt;
  }

 private:
  static constexpr int kWaves = 48;
  struct Wave {
    double kx, ky, phase, amplitude;
  };
  std::array<Wave, kWaves> waves_;
  double offset_ = 0.0;
};

/// Perceptron axes (x left, y up, z out) on a body (x forward, y left, z up), pitched down.
inline Pose perceptron_mount(double height_m, double pitch_down_rad, double forward_m = 0.0) {
  Eigen::Matrix3d axes;  // columns: sensor x, y, z in the body frame
  axes << 0, 0, 1, 1, 0, 0, 0, 1, 0;
  Pose mount;
  mount.rotation = Eigen::AngleAxisd(pitch_down_rad, Eigen::Vector3d::UnitY()) * Eigen::Quaterniond(axes);
  mount.translation_m = {forward_m, 0.0, height_m};
  return mount;
}

struct Scan {
  RangeFrame frame;
  Grid<float> truth_m;  ///< exact range, NaN = sky
};

/// Scans with the pose of each row's own time. Counts are exact, rounded and wrapped where the sensor is ambiguous;
/// `sigma_m` adds normal noise; sky is NaN.
inline Scan scan(std::shared_ptr<const Projection> projection, const SensorConfig& sensor, const PoseTrack& track,
                 const Scene& scene, double sigma_m = 0.0, bool quantise = true) {
  const Projection& p = *projection;
  Scan out;
  out.frame.projection = projection;
  out.frame.sensor = std::make_shared<const SensorConfig>(sensor);
  out.frame.range_m.assign(p.rows, p.columns, std::numeric_limits<float>::quiet_NaN());
  out.truth_m = out.frame.range_m;
  for (int r = 0; r < p.rows; ++r) {
    const Time time = Time{} + r * sensor.row_period;
    const auto T_map_body = track.at(time);
    out.frame.row_time.push_back(time);
    out.frame.T_map_body.push_back(*T_map_body);
    const Pose T_map_sensor = *T_map_body * sensor.T_body_sensor;
    for (int c = 0; c < p.columns; ++c) {
      const PixelRay ray = pixel_ray(p.config, r, c);
      const auto range = scene(T_map_sensor * ray.origin_m, T_map_sensor.rotation * ray.direction);
      if (!range) continue;
      out.truth_m(r, c) = static_cast<float>(*range);
      double count = count_at_range(ray, *range + sigma_m * random_normals(11, 0, c, r)[0]);
      if (quantise) count = p.ambiguity_m > 0.0 ? wrapped_count(count) : std::round(count);
      out.frame.range_m(r, c) = p.range_offset_m(r, c) + static_cast<float>(count) * p.range_per_count_m(r, c);
    }
  }
  return out;
}

inline PoseTrack standing(const Pose& pose = {}) {
  return PoseTrack::fixed(pose);
}

inline std::uint64_t accounted(const PixelCounts& n) {
  return n.points + n.no_return + n.untrusted_row + n.out_of_limits + n.self + n.speckle + n.mixed + n.ambiguous;
}

inline Eigen::Vector3d map_point(const PointFrame& points, std::size_t i) {
  return points.anchor_map_m + Eigen::Vector3f(points.x_m[i], points.y_m[i], points.z_m[i]).cast<double>();
}

/// Everything off that could drop a pixel.
inline FilterConfig no_filter() {
  FilterConfig filter;
  filter.speckle_min_pixels = 0;
  filter.mixed_pixels = false;
  filter.range_max_m = 1e5;
  return filter;
}

inline std::shared_ptr<const Projection> projection_of(ProjectionKind kind, int rows, int columns) {
  ProjectionConfig config;
  config.kind = kind;
  if (kind == ProjectionKind::pinhole) {
    config.fx_px = config.fy_px = 0.8 * columns;
    config.cx_px = 0.5 * columns;
    config.cy_px = 0.5 * rows;
  }
  return *make_projection(config, rows, columns);
}

/// An unambiguous Perceptron: the geometry without the wrap.
inline std::shared_ptr<const Projection> unambiguous_perceptron(int rows, int columns) {
  ProjectionConfig config;
  config.kind = ProjectionKind::perceptron_cmu;
  config.ambiguity_m = 0.0;
  return *make_projection(config, rows, columns);
}

}  // namespace scree::test
