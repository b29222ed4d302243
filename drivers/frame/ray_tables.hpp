#pragma once
// Per-pixel constants that follow from the rays and the mounting alone: made once per sensor, read every frame.

#include <memory>

#include "core/executor.hpp"
#include "core/grid.hpp"
#include "drivers/frame/projection.hpp"
#include "drivers/frame/sensor.hpp"

namespace scree {

struct RayTables {
  std::shared_ptr<const Projection> projection;
  std::shared_ptr<const SensorConfig> sensor;

  float quantum_m = 0.0F;  ///< the largest range of one count

  /// Ranges at which the ray is inside the self mask; near > far where it misses. Empty without a mask.
  Grid<float> self_near_m, self_far_m;

  // Images only. Edge (r, c) of `right` leads to (r, c + 1), of `down` to (r + 1, c).
  /// A range step above grazing · range meets the ray at less than FilterConfig::grazing_rad.
  Grid<float> grazing_right, grazing_down;
  /// Level ground seen along an edge steps by level · range; 0 where a ray does not look down clearly.
  Grid<float> level_right, level_down;

  /// Ambiguous sensors only: the ranges at which the ray can meet ground near the robot, where the phase tells them
  /// apart; near > far elsewhere.
  Grid<float> ground_near_m, ground_far_m;
  float anchor_width_m = 0.0F;  ///< far − near of the pixels whose readings anchor a surface is at most this
  bool anchors(std::size_t i) const {
    return ground_far_m[i] - ground_near_m[i] <= anchor_width_m && ground_near_m[i] <= ground_far_m[i];
  }
  /// Ambiguous sensors only: where the ray meets level ground through the body's origin; 0 where it does not.
  Grid<float> level_ground_m;

  /// Does nothing when both objects are those of the last call.
  void prepare(const std::shared_ptr<const Projection>& new_projection,
               const std::shared_ptr<const SensorConfig>& new_sensor, Executor& executor);
};

}  // namespace scree
