#pragma once
// Numbers that go onto the wire: what does not fit becomes the largest that does.

#include <algorithm>
#include <cstdint>
#include <limits>

#include "core/time.hpp"

namespace scree::node {

template <class Unsigned>
Unsigned saturate(std::int64_t value) {
  return static_cast<Unsigned>(
      std::clamp<std::int64_t>(value, 0, static_cast<std::int64_t>(std::numeric_limits<Unsigned>::max())));
}

inline std::int64_t to_milliseconds(Duration duration) {
  return std::chrono::duration_cast<std::chrono::milliseconds>(duration).count();
}

}  // namespace scree::node
