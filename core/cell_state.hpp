#pragma once
// What the map knows about a cell. The numbers are the wire's.

#include <cstdint>

namespace scree {

enum class CellState : std::uint8_t {
  never_seen = 0,     ///< no ray came near it
  occluded = 1,       ///< inside a ray's shadow
  possible_drop = 2,  ///< the ground must be below what the rays crossed
  reconstructed = 3,  ///< filled between measured cells
  measured = 4,       ///< holds at least one accepted return
};

}  // namespace scree
