#pragma once
// What the header of a PCD or PLY file promises, checked against the file's size before PCL allocates for it.

#include <cstdint>
#include <string>
#include <string_view>

#include "core/result.hpp"

namespace scree::io {

inline constexpr std::size_t kPointHeaderMaxBytes = 65536;

/// `head`: the first kPointHeaderMaxBytes bytes, or the whole file. Every point takes at least one byte (compressed
/// PCD: a sixteenth), so a header that counts more lies. Errors: bad_data with line, expected and found.
Status check_pcd_header(std::string_view head, std::uintmax_t file_bytes, const std::string& name);
Status check_ply_header(std::string_view head, std::uintmax_t file_bytes, const std::string& name);

}  // namespace scree::io
