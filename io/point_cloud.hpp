#pragma once
// Point files: PCD and PLY (PCL), KITTI-like .bin, text x y z.

#include <Eigen/Core>
#include <filesystem>
#include <vector>

#include "core/result.hpp"

namespace scree::io {

/// One row per point: x, y, z, intensity (0 where the file has none). Non-finite points are dropped and counted.
/// Coordinates are relative to `origin_m`, which is 0 unless the file's own numbers need more than float32 has.
struct PointCloud {
  std::vector<Eigen::Vector4f> points;
  Eigen::Vector3d origin_m = Eigen::Vector3d::Zero();
  std::size_t dropped_non_finite = 0;
};

/// By extension: .pcd, .ply, .bin (float32 x y z intensity), .xyz/.txt/.csv (blanks or commas; an optional header line
/// names the columns). Errors: no_input, bad_data (with byte offset or line).
Result<PointCloud> read_point_cloud(const std::filesystem::path& file);

}  // namespace scree::io
