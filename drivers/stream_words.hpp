#pragma once
// The words of a streamed frame → metres along the rays.

#include <cstddef>
#include <cstdint>

namespace scree::drivers::stream {

/// Of each pixel: offset and metres per count; `invalid_raw` −1 = none.
struct RangeLaw {
  const float* offset_m;
  const float* per_count_m;
  std::int32_t invalid_raw;
};

/// Where each pixel goes: metres (NaN = no return), and the counts as the device told them.
struct PixelsOut {
  float* range_m;
  std::uint16_t* raw;
  std::uint16_t* reflectance;  ///< not written by ranges_of_counts
};

/// 2-byte words; NaN for the invalid count. Returns all counts or-ed together. One multiply-add a pixel, vectorised.
std::uint16_t ranges_of_counts(const std::uint8_t* words, std::size_t count, const RangeLaw& law, const PixelsOut& out);

/// 4-byte words with the reflectance at bit `shift`; NaN also where it is below `min_reflectance`.
void ranges_of_words(const std::uint8_t* words, std::size_t count, const RangeLaw& law, int shift,
                     std::uint32_t min_reflectance, const PixelsOut& out);

}  // namespace scree::drivers::stream
