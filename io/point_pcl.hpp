#pragma once
// What point files need PCL for; inside io/ only. Without PCL both are the error `unavailable`.

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "io/point_cloud.hpp"
#include "io/point_header.hpp"

namespace scree::io {

/// Binary and compressed data of a PCD file, all of it in `bytes`, behind a header that check_pcd_header accepted.
Result<PointCloud> unpack_binary_pcd(std::span<const std::uint8_t> bytes, const PcdHeader& header,
                                     const std::string& name);

/// A PLY file whose header check_ply_header accepted.
Result<PointCloud> read_checked_ply(const std::filesystem::path& file);

}  // namespace scree::io
