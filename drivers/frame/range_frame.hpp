#pragma once
// A frame as a source delivers it: raw counts turned into metres along each ray, nothing filtered yet.

#include <cstdint>
#include <memory>
#include <vector>

#include "core/grid.hpp"
#include "core/pose.hpp"
#include "core/time.hpp"
#include "drivers/frame/projection.hpp"
#include "drivers/frame/sensor.hpp"

namespace scree {

/// How well a pose is known, as its source tells it; 0 = not stated.
struct PoseVariance {
  Eigen::Vector3d position_m2 = Eigen::Vector3d::Zero();    ///< of x, y, z
  Eigen::Vector3d attitude_rad2 = Eigen::Vector3d::Zero();  ///< of small rotations about the map's x, y, z
};

struct RangeFrame {
  std::shared_ptr<const Projection> projection;
  std::shared_ptr<const SensorConfig> sensor;
  std::uint64_t sequence = 0;
  Time time;                     ///< of row 0
  MonotonicTime received;        ///< when the source delivered it
  Grid<float> range_m;           ///< along the ray; NaN = no return; modulo projection->ambiguity_m
  std::vector<Time> row_time;    ///< one per row
  std::vector<Pose> T_map_body;  ///< one per row, interpolated to row_time
  PoseVariance pose_variance;    ///< of the last row; an error that the whole frame shares

  /// The counts that range_m was made of, as the device told them, for whoever records the frame; empty = not kept.
  Grid<std::uint16_t> raw;
  Grid<std::uint16_t> reflectance;  ///< the same; empty = the device tells none
};

}  // namespace scree
