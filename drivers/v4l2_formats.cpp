#include "drivers/v4l2_formats.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace scree::drivers::v4l2 {

const RangeFormat* range_format(std::uint32_t fourcc) {
  for (const RangeFormat& format : kRangeFormats)
    if (format.fourcc == fourcc) return &format;
  return nullptr;
}

const RangeFormat* range_format(const std::string& name) {
  for (const RangeFormat& format : kRangeFormats)
    if (format.name == name) return &format;
  return nullptr;
}

const RangeFormat* choose_format(const RangeFormat* asked, std::span<const std::uint32_t> offered) {
  const auto is_offered = [&](const RangeFormat& format) {
    return std::find(offered.begin(), offered.end(), format.fourcc) != offered.end();
  };
  if (asked) return is_offered(*asked) ? asked : nullptr;
  const auto* found = std::find_if(kRangeFormats.begin(), kRangeFormats.end(), is_offered);
  return found == kRangeFormats.end() ? nullptr : found;
}

std::string fourcc_text(std::uint32_t fourcc) {
  std::string text;
  for (int i = 0; i < 4; ++i) {
    const auto letter = static_cast<char>(fourcc >> (8 * i) & 0xFFU);
    if (letter < ' ' || letter > '~') return fmt::format("0x{:08x}", fourcc);
    text += letter;
  }
  text.erase(text.find_last_not_of(' ') + 1);
  return text.empty() ? fmt::format("0x{:08x}", fourcc) : text;
}

}  // namespace scree::drivers::v4l2
