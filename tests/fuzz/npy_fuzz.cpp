// The .npy reader over any bytes.

#include <cstddef>
#include <cstdint>
#include <span>

#include "io/npy.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto grid = scree::io::parse_npy(std::as_bytes(std::span(data, size)), "input");
  if (grid && grid->size() * sizeof(float) > size) __builtin_trap();  // more cells than bytes
  return 0;
}
