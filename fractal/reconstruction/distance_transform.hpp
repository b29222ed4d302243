#pragma once
// Exact distances on a grid, without a limit.

#include <cstdint>

#include "core/executor.hpp"
#include "core/grid.hpp"

namespace scree::fractal {

/// Euclidean distance transform: the square of the distance in cells to the nearest set cell, in whole numbers and so
/// exact. Columns first, by two sweeps; then each row, by trying offsets 1, 2, … while they can still gain, vectorised,
/// and where more than kDirect of them would be needed by the lower envelope of parabolas: O(cells) for any input.
/// Source: [FH12], the envelope in integers [MRH00]. (Distances up to a few cells only: mapping/distance.hpp.)
class DistanceTransform {
 public:
  /// Of every cell when none is set.
  static constexpr std::int32_t kNone = 1 << 29;
  static constexpr int kMaxSide = 16000;

  /// Sides ≤ kMaxSide. No allocation when the shape is unchanged.
  void transform(const Grid<std::uint8_t>& set, Executor& executor, Grid<std::int32_t>& squared_cells);

 private:
  static constexpr int kDirect = 32;

  Grid<std::int32_t> squared_;         ///< along the column
  Grid<std::int32_t> vertex_, start_;  ///< of each row's envelope: parabolas, and where each begins to be the lowest
};

}  // namespace scree::fractal
