#pragma once
// Point files: PCD and PLY (PCL), KITTI-like .bin, text x y z.

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
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

/// By extension: .pcd (PCL but for ASCII data), .ply (PCL), .bin (float32 x y z intensity), .xyz/.txt/.csv (blanks or
/// commas; an optional header line names the columns). Errors: no_input, bad_data (with byte offset or line).
Result<PointCloud> read_point_cloud(const std::filesystem::path& file);

inline constexpr std::size_t kPointFileMaxBytes = std::size_t{8} << 30;

/// float32 x y z intensity, little-endian, non-finite points included; the allocation of `points` is kept.
/// Errors: bad_data (not a multiple of 16 bytes).
Status parse_bin_points(std::span<const std::uint8_t> bytes, const std::string& name,
                        std::vector<Eigen::Vector4f>& points);

/// Text points: a line each, columns apart by blanks or one comma or semicolon. Lines that begin with # or // and empty
/// ones are skipped. A first line that is not numeric names the columns (x y z, intensity; others are ignored); without
/// one the first three are x y z, and of exactly four the last is the intensity. `first_line` is the number of the
/// text's first line in messages. Errors: bad_data with the line.
Result<PointCloud> parse_point_text(std::string_view text, const std::string& name, std::size_t first_line = 1);

}  // namespace scree::io
