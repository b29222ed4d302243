#pragma once
// What became of a pixel on its way to a point. Every pixel ends in exactly one state.

#include <cstdint>

namespace scree {

enum class PixelState : std::uint8_t {
  kept,
  no_return,
  untrusted_row,
  out_of_limits,
  self,
  speckle,
  mixed,
  ambiguous,
};
inline constexpr int kPixelStates = 8;

}  // namespace scree
