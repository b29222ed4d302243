#pragma once
// For each point the nearest among those before it.

#include <array>
#include <cstdint>
#include <vector>

#include "fractal/vecchia_points.hpp"

namespace scree::fractal {

inline constexpr int kVecchiaNeighbours = 13;

/// Indices, nearest first; only the first min(i, kVecchiaNeighbours) of point i are set.
using Predecessors = std::array<std::int32_t, kVecchiaNeighbours>;

/// Exact. A grid of about three points a cell, rebuilt whenever the number of points in it has doubled. Cost: below
/// 1 µs a point where they are spread evenly; with most of them in few cells up to O(N) a point.
std::vector<Predecessors> nearest_predecessors(const std::vector<VecchiaPoint>& points);

}  // namespace scree::fractal
