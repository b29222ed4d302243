#pragma once
// How the ranges of neighbouring pixels compare: one byte an edge of the image's 4-neighbour graph.

#include <cstdint>

#include "core/executor.hpp"
#include "core/grid.hpp"
#include "drivers/frame/ray_tables.hpp"

namespace scree {

/// Bits of an edge from a pixel to its right or lower neighbour. 0 where either has no range.
namespace edge {
inline constexpr std::uint8_t kJoined = 1;   ///< within the join tolerance, modulo the ambiguity
inline constexpr std::uint8_t kTight = 2;    ///< within a quarter of it
inline constexpr std::uint8_t kClose = 4;    ///< steps by less than noise or a grazing surface would
inline constexpr std::uint8_t kPresent = 8;  ///< both pixels have a range
inline constexpr int kWrapShift = 4;         ///< two bits: 1 + intervals by which the range grows along the edge

inline int wraps(std::uint8_t bits) {
  return ((bits >> kWrapShift) & 3) - 1;
}
}  // namespace edge

struct ImageEdges {
  Grid<std::uint8_t> right, down;

  /// `range_m`: NaN = none. Rows are independent.
  void compute(const Grid<float>& range_m, const RayTables& tables, Executor& executor);
};

}  // namespace scree
