#pragma once
// What the header of a PCD or PLY file promises, checked against the file's size before PCL allocates for it.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.hpp"

namespace scree::io {

inline constexpr std::size_t kPointHeaderMaxBytes = 65536;

/// `head`: the first kPointHeaderMaxBytes bytes, or the whole file. Strict, because PCL 1.13 crashes on headers that
/// are not what it thinks they are. Every point takes at least one byte (compressed PCD: a sixteenth), so a header that
/// counts more lies. Errors: bad_data with line, expected and found.
struct PcdHeader {
  std::vector<std::string> fields;
  std::vector<std::uint64_t> sizes;   ///< one per field: 1, 2, 4, 8 bytes
  std::vector<char> types;            ///< one per field: F, I, U
  std::vector<std::uint64_t> counts;  ///< one per field, above 0
  std::uint64_t width = 0, height = 1, points = 0;
  std::string data;             ///< ascii, binary, binary_compressed
  std::size_t data_offset = 0;  ///< of the first byte behind the header
  std::size_t data_line = 0;    ///< number of the DATA line

  std::uint64_t point_bytes() const;
};
Result<PcdHeader> check_pcd_header(std::string_view head, std::uintmax_t file_bytes, const std::string& name);
Status check_ply_header(std::string_view head, std::uintmax_t file_bytes, const std::string& name);

}  // namespace scree::io
