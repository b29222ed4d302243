#pragma once
// The text header of a USF range file, and where its payload begins.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "core/result.hpp"

namespace scree::drivers {

/// Views into the parsed bytes.
struct UsfHeader {
  int rows = 0;
  int columns = 0;
  std::array<std::string_view, 10> lines;  ///< without their ends
  std::size_t payload_offset = 0;          ///< 4·rows·columns bytes follow, to the end of the file
  std::string warning;                     ///< text that `lenient` let pass
};

/// The first line is printable text with a colon: nothing that 12-bit ranges can spell.
bool looks_like_usf(std::span<const std::uint8_t> bytes);

/// Lines are read by position, not by key. Errors: bad_data with expected, found and byte offset.
Result<UsfHeader> parse_usf_header(std::span<const std::uint8_t> bytes, const std::string& name, bool lenient);

}  // namespace scree::drivers
