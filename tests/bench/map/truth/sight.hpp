#pragma once
// Which places a sensor could have seen: misses of its sampling are told from shadows.

#include <vector>

#include "drivers/simulator.hpp"

namespace scree::bench {

/// The sensor's true places at the middle row of each frame, and its field of view as ranges of two angles.
class Sight {
 public:
  explicit Sight(const drivers::Simulator& simulator);
  /// In some frame the place lies in the field of view and nothing stands before it (by more than 5 cm): what kept it
  /// from being measured has nothing to do with its height. Cost: a ray a frame.
  bool open(const Eigen::Vector3d& point_map_m) const;

 private:
  bool in_view(const Eigen::Vector3d& point_sensor_m) const;
  Eigen::Vector2d angles(const Eigen::Vector3d& direction) const;

  const drivers::Simulator& simulator_;
  bool spherical_;
  double range_m_;
  Eigen::Vector2d low_rad_, high_rad_;
  std::vector<Pose> T_map_sensor_;
};

}  // namespace scree::bench
