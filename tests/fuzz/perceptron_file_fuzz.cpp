// Any bytes: the range-file reader accepts or refuses, and what it accepts survives writing and reading.

#include <cstdint>
#include <cstdlib>

#include "drivers/perceptron_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace scree::drivers;
  static RangeFile file, back;
  for (const bool lenient : {false, true}) {
    const RangeFileOptions options{.reflectance_shift = lenient ? 12 : 0, .lenient = lenient};
    if (!parse_range_file({data, size}, "fuzz", options, file)) continue;
    const int shift = file.reflectance.empty() ? 0 : 12;
    const auto bytes = encode_range_file(file, shift);
    if (!bytes) continue;  // a header that only an unusual line end made fit
    if (!parse_range_file(*bytes, "fuzz", {.reflectance_shift = shift}, back)) std::abort();
    if (!(back.raw == file.raw) || !(back.reflectance == file.reflectance)) std::abort();
  }
  return 0;
}
