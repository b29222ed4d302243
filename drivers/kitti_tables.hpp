#pragma once
// The text files of a KITTI odometry sequence. Blank lines are nothing; errors are bad_data "name:line: expected …,
// found …". A transform is twelve numbers, the upper three rows of a rigid 4 × 4 matrix, row by row.
// Source: [GLU12] Geiger, Lenz, Urtasun, "Are we ready for autonomous driving?", CVPR 2012, and the odometry devkit.

#include <string>
#include <string_view>
#include <vector>

#include "core/pose.hpp"
#include "core/result.hpp"
#include "core/time.hpp"

namespace scree::drivers {

/// calib.txt → T_camera_velodyne: the last line that begins with "Tr:"; there must be one.
Result<Pose> parse_kitti_calibration(std::string_view text, const std::string& name);

/// times.txt: decimal seconds that increase strictly.
Result<std::vector<Time>> parse_kitti_times(std::string_view text, const std::string& name);

/// poses.txt: T_camera0_camera of each scan.
Result<std::vector<Pose>> parse_kitti_poses(std::string_view text, const std::string& name);

}  // namespace scree::drivers
