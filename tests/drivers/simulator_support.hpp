#pragma once
// What the tests of the simulated scanner share.

#include <cmath>
#include <filesystem>
#include <gtest/gtest.h>
#include <string>
#include <unistd.h>

#include "drivers/simulator.hpp"

namespace scree::drivers {

struct Scratch {
  std::filesystem::path folder =
      std::filesystem::path(testing::TempDir()) / ("scree_simulator_" + std::to_string(getpid()));
  Scratch() { std::filesystem::create_directories(folder); }
  ~Scratch() {
    std::error_code ignored;
    std::filesystem::remove_all(folder, ignored);
  }
};

inline std::filesystem::path scratch(const std::string& name) {
  static const Scratch scratch;
  return scratch.folder / name;
}

/// A small rough terrain: 24 m, D 2.3, 0.12 m at 1 m.
inline SimulatorConfig small_drive(const std::string& sensor, bool noise) {
  SimulatorConfig config;
  config.terrain = "fbm:2.3,0.12,7,24,0.1";
  config.sensor = sensor;
  config.trajectory = "arc:-4,-3,20,6,60,1.5";  // moves and turns
  config.noise = noise;
  config.seed = 5;
  return config;
}

inline Simulator made(const SimulatorConfig& config) {
  auto simulator = Simulator::make(config);
  EXPECT_TRUE(simulator) << simulator.error().message;
  return *std::move(simulator);
}

/// Raw counts → Cartesian, from scratch: pixel_ray in double, the pose of the row's own time from the pose table.
struct Agreement {
  std::size_t returns = 0;
  std::size_t next_to_invalid = 0;  ///< true count within half of 0 modulo the interval: recorded a count off
  double worst_counts = 0.0;        ///< of |range − true range| over the others
  double worst_surface_m = 0.0;     ///< of the true point's height over the terrain
};

inline Agreement compare(const Simulator& simulator, const SimulatedFrame& frame) {
  const SensorConfig& sensor = simulator.description().sensor;
  const double ambiguity = sensor.projection.ambiguity_m;
  Agreement agreement;
  for (int r = 0; r < frame.raw.rows(); ++r) {
    const auto body = simulator.poses().at(frame.time + r * sensor.row_period);
    EXPECT_TRUE(body);
    const Pose T_map_sensor = *body * sensor.T_body_sensor;
    for (int c = 0; c < frame.raw.columns(); ++c) {
      const double truth = frame.true_range_m(r, c);
      if (frame.raw(r, c) == 0) continue;
      ++agreement.returns;
      const PixelRay ray = pixel_ray(sensor.projection, r, c);
      double error = ray.range_offset_m + frame.raw(r, c) * ray.range_per_count_m - truth;
      if (ambiguity > 0.0) error = std::remainder(error, ambiguity);
      const double true_count = count_at_range(ray, truth);
      const bool next_to_invalid = ambiguity > 0.0 && std::abs(std::remainder(true_count, 4096.0)) <= 0.501;
      agreement.next_to_invalid += next_to_invalid;
      if (next_to_invalid)
        EXPECT_LE(std::abs(error), 1.01 * ray.range_per_count_m);
      else
        agreement.worst_counts = std::max(agreement.worst_counts, std::abs(error) / ray.range_per_count_m);
      const Eigen::Vector3d point = T_map_sensor * (ray.origin_m + truth * ray.direction);
      const double height = simulator.terrain().height_m(point.x(), point.y());
      agreement.worst_surface_m = std::max(agreement.worst_surface_m, std::abs(point.z() - height));
    }
  }
  return agreement;
}

}  // namespace scree::drivers
