#pragma once
// Exact distances on a grid, up to a limit.

#include "core/executor.hpp"
#include "core/grid.hpp"

namespace scree::mapping {

/// Euclidean distance transform that is exact up to a limit: the square of the distance in cells to the nearest set
/// cell, +inf beyond `limit_cells`. Two separable passes over offsets −limit … limit; the usual unbounded transform
/// [FH12] buys nothing where the reach is a few cells. Cost: O(cells · limit), vectorised.
class BoundedDistance {
 public:
  void transform(const Grid<std::uint8_t>& set, int limit_cells, Executor& executor, Grid<float>& squared_cells);

 private:
  Grid<float> vertical_;  ///< squared distance along the column, with a margin of +inf left and right
};

/// Cells that lie between set cells: the morphological closing of `set` with a disc of `reach_cells` (dilation, then
/// erosion). It bridges gaps up to twice the reach wide and does not grow outwards from the frontier, so filling these
/// cells interpolates. Cells outside the grid count as unknown and do not erode.
class Closing {
 public:
  /// closed: 1 = within `reach_cells` of a set cell and between set cells (set cells are closed too).
  void close(const Grid<std::uint8_t>& set, double reach_cells, Executor& executor, Grid<std::uint8_t>& closed);

 private:
  BoundedDistance distance_;
  Grid<float> squared_;
  Grid<std::uint8_t> outside_;
};

}  // namespace scree::mapping
