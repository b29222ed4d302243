#pragma once
// Each row's own sensor pose, ready for float arithmetic near the robot.

#include <Eigen/Core>
#include <vector>

#include "drivers/frame/range_frame.hpp"

namespace scree {

/// p_map − anchor = rotation · p_sensor + origin_m
struct RowPose {
  Eigen::Matrix3f rotation = Eigen::Matrix3f::Identity();
  Eigen::Vector3f origin_m = Eigen::Vector3f::Zero();
};

struct RowPoses {
  Eigen::Vector3d anchor_map_m = Eigen::Vector3d::Zero();  ///< last body position in whole metres: exact in float
  std::vector<RowPose> rows;

  void compute(const RangeFrame& frame);
};

}  // namespace scree
