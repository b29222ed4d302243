// Any bytes: the depth-image reader accepts or refuses, and what it accepts survives writing and reading.

#include <cstdint>
#include <cstdlib>

#include "drivers/depth_image.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static scree::Grid<std::uint16_t> raw, back;
  if (!scree::drivers::parse_depth_image({data, size}, "fuzz", raw)) return 0;
  const auto bytes = scree::drivers::encode_depth_image(raw);
  if (!bytes || !scree::drivers::parse_depth_image(*bytes, "fuzz", back) || !(back == raw)) std::abort();
  return 0;
}
