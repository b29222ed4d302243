#pragma once
// zlib's CRC-32.

#include <cstdint>
#include <span>

namespace scree::drivers {

std::uint32_t crc32_of(std::span<const std::uint8_t> bytes);

}  // namespace scree::drivers
