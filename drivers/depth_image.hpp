#pragma once
// 16-bit depth images: binary PGM ("P5") with big-endian samples.

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "core/grid.hpp"
#include "core/result.hpp"

namespace scree::drivers {

inline constexpr int kDepthImageMaxSide = 16384;
inline constexpr std::size_t kDepthImageMaxBytes = std::size_t{1} << 30;

/// Decodes an image held in memory into `raw` (rows × columns, row 0 the top), whose allocation is kept. Header
/// comments are skipped; maxval must be 256..65535 (fewer bits are no depth image) and bounds every sample; the
/// payload must fill the rest exactly. Errors: bad_data with expected, found and byte offset. Cost: one pass.
Status parse_depth_image(std::span<const std::uint8_t> bytes, const std::string& name, Grid<std::uint16_t>& raw);

/// Errors: no_input, io, and those of parse_depth_image.
Result<Grid<std::uint16_t>> read_depth_image(const std::filesystem::path& file);

/// The bytes of a P5 file with maxval 65535. Errors: bad_data (an empty or too large image).
Result<std::vector<std::uint8_t>> encode_depth_image(const Grid<std::uint16_t>& raw);

}  // namespace scree::drivers
