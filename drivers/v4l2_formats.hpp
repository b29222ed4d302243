#pragma once
// The pixel formats of V4L2 that are range images: 16-bit little-endian words of which one pixel is one.

#include <array>
#include <cstdint>
#include <span>
#include <string>

namespace scree::drivers::v4l2 {

/// Four characters, the first in the lowest byte, as V4L2 has them.
constexpr std::uint32_t fourcc_of(const char (&name)[5]) {
  std::uint32_t code = 0;
  for (int i = 3; i >= 0; --i) code = code << 8U | static_cast<std::uint8_t>(name[i]);
  return code;
}

struct RangeFormat {
  const char* name;  ///< as the configuration and messages spell it
  std::uint32_t fourcc;
  std::uint16_t mask;  ///< the bits of a word that are the count
};

/// In the order in which they are preferred. Y12 has its 12 bits in the low end; the others are padding.
inline constexpr std::array<RangeFormat, 3> kRangeFormats{{
    {"Z16", fourcc_of("Z16 "), 0xFFFF},
    {"Y16", fourcc_of("Y16 "), 0xFFFF},
    {"Y12", fourcc_of("Y12 "), 0x0FFF},
}};
inline constexpr const char* kRangeFormatNames = "Z16, Y16 or Y12";

/// Null where it is none of them.
const RangeFormat* range_format(std::uint32_t fourcc);
const RangeFormat* range_format(const std::string& name);

/// The one asked for, or the first of kRangeFormats where `asked` is null; null where it is not offered.
const RangeFormat* choose_format(const RangeFormat* asked, std::span<const std::uint32_t> offered);

/// "Z16", "YUYV"; what is not visible ASCII as its hexadecimal number; without trailing blanks.
std::string fourcc_text(std::uint32_t fourcc);

}  // namespace scree::drivers::v4l2
