#pragma once
// Frames with known ground, made point by point.

#include <cmath>
#include <functional>
#include <thread>
#include <vector>

#include "core/executor.hpp"
#include "core/random.hpp"
#include "drivers/frame/point_frame.hpp"

namespace scree::mapping::test {

/// Cuts every loop into `ranges` pieces and runs them last piece first: results must not notice.
class ReversedRanges final : public Executor {
 public:
  explicit ReversedRanges(int ranges) : ranges_(ranges) {}
  void for_ranges(int count, const std::function<void(int, int)>& body) override {
    for (int i = ranges_ - 1; i >= 0; --i) {
      const int begin = static_cast<int>(std::int64_t{count} * i / ranges_);
      const int end = static_cast<int>(std::int64_t{count} * (i + 1) / ranges_);
      if (begin < end) body(begin, end);
    }
  }

 private:
  int ranges_;
};

/// Each range on a thread of its own.
class ThreadedRanges final : public Executor {
 public:
  explicit ThreadedRanges(int ranges) : ranges_(ranges) {}
  void for_ranges(int count, const std::function<void(int, int)>& body) override {
    std::vector<std::jthread> threads;
    for (int i = 0; i < ranges_; ++i) {
      const int begin = static_cast<int>(std::int64_t{count} * i / ranges_);
      const int end = static_cast<int>(std::int64_t{count} * (i + 1) / ranges_);
      if (begin < end) threads.emplace_back([&body, begin, end] { body(begin, end); });
    }
  }

 private:
  int ranges_;
};

/// A frame of one row whose sensor sits at `sensor_m` (map frame; the anchor is the map's origin).
inline PointFrame empty_frame(const Eigen::Vector3f& sensor_m) {
  PointFrame frame;
  frame.row_begin = {0, 0};
  frame.sensor_m = {sensor_m};
  return frame;
}

inline void add_point(PointFrame& frame, double x_m, double y_m, double z_m, double range_sigma_m = 0.0) {
  frame.x_m.push_back(static_cast<float>(x_m));
  frame.y_m.push_back(static_cast<float>(y_m));
  frame.z_m.push_back(static_cast<float>(z_m));
  const Eigen::Vector3f ray = Eigen::Vector3d(x_m, y_m, z_m).cast<float>() - frame.sensor_m.back();
  frame.range_m.push_back(ray.norm());
  frame.direction_z.push_back(ray.norm() > 0.0F ? ray.z() / ray.norm() : -1.0F);
  frame.range_variance_m2.push_back(static_cast<float>(range_sigma_m * range_sigma_m));
  frame.row_begin.back() = static_cast<std::uint32_t>(frame.x_m.size());
}

using Height = std::function<double(double x_m, double y_m)>;

/// What a scanner at `sensor_m` sees of a height field: per azimuth a fan of rays, each marched to its first crossing
/// (20 mm steps, then bisected). Rays that meet nothing within `range_m` return nothing.
inline PointFrame scan(const Height& ground, const Eigen::Vector3d& sensor_m, double azimuth_from_rad,
                       double azimuth_to_rad, int azimuths, double elevation_from_rad, double elevation_to_rad,
                       int elevations, double range_m) {
  PointFrame frame = empty_frame(sensor_m.cast<float>());
  for (int a = 0; a < azimuths; ++a) {
    const double azimuth = azimuth_from_rad + (azimuth_to_rad - azimuth_from_rad) * (a + 0.5) / azimuths;
    for (int e = 0; e < elevations; ++e) {
      const double elevation = elevation_from_rad + (elevation_to_rad - elevation_from_rad) * (e + 0.5) / elevations;
      const Eigen::Vector3d ray(std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
                                std::sin(elevation));
      const auto below = [&](double t) {
        const Eigen::Vector3d p = sensor_m + t * ray;
        return p.z() < ground(p.x(), p.y());
      };
      double t = 0.2;
      while (t < range_m && !below(t)) t += 0.02;
      if (t >= range_m) continue;
      double near = t - 0.02;
      double far = t;
      for (int i = 0; i < 20; ++i) (below(0.5 * (near + far)) ? far : near) = 0.5 * (near + far);
      const Eigen::Vector3d p = sensor_m + far * ray;
      add_point(frame, p.x(), p.y(), p.z());
    }
  }
  return frame;
}

}  // namespace scree::mapping::test
