#include "drivers/stream_words.hpp"

#include <cstring>
#include <limits>

#include "core/simd.hpp"
#include "drivers/frame_stream.hpp"

namespace scree::drivers::stream {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

}  // namespace

SCREE_CLONES std::uint16_t ranges_of_counts(const std::uint8_t* words, std::size_t count, const RangeLaw& law,
                                            const PixelsOut& out) {
  float* const __restrict range_m = out.range_m;
  std::uint16_t* const __restrict raws = out.raw;
  std::uint16_t any = 0;
  for (std::size_t i = 0; i < count; ++i) {
    std::uint16_t raw = 0;
    std::memcpy(&raw, words + 2 * i, 2);
    any = static_cast<std::uint16_t>(any | raw);
    const float range = law.offset_m[i] + static_cast<float>(raw) * law.per_count_m[i];
    range_m[i] = raw == law.invalid_raw ? kNaN : range;
    raws[i] = raw;
  }
  return any;
}

SCREE_CLONES void ranges_of_words(const std::uint8_t* words, std::size_t count, const RangeLaw& law, int shift,
                                  std::uint32_t min_reflectance, const PixelsOut& out) {
  float* const __restrict range_m = out.range_m;
  std::uint16_t* const __restrict raws = out.raw;
  std::uint16_t* const __restrict reflectances = out.reflectance;
  for (std::size_t i = 0; i < count; ++i) {
    std::uint32_t word = 0;
    std::memcpy(&word, words + 4 * i, 4);
    const auto raw = static_cast<std::int32_t>(word & kRangeBits);
    const std::uint32_t reflectance = (word >> shift) & kRangeBits;
    const float range = law.offset_m[i] + static_cast<float>(raw) * law.per_count_m[i];
    range_m[i] = raw == law.invalid_raw || reflectance < min_reflectance ? kNaN : range;
    raws[i] = static_cast<std::uint16_t>(raw);
    reflectances[i] = static_cast<std::uint16_t>(reflectance);
  }
}

}  // namespace scree::drivers::stream
