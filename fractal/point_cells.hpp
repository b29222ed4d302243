#pragma once
// Points sorted into square cells, row after row, so that what is near a point is a few contiguous runs.

#include <vector>

#include "fractal/pair_kernel.hpp"

namespace scree::fractal {

class PointCells {
 public:
  /// Takes the points whose indices are given. Cost: O(points + cells), cells ≤ 4·points + 4.
  PointCells(const PointColumns& points, const std::vector<int>& indices, double cell_m);

  const PairColumns& columns() const { return columns_; }
  int count() const { return columns_.count; }
  /// Runs of sorted points behind point i that hold every one within `reach_m` of it: each pair is met once.
  void runs_behind(int i, double reach_m, std::vector<IndexRun>& runs) const;

 private:
  int column_of(double x) const;
  int row_of(double y) const;

  PairColumns columns_;
  std::vector<int> starts_;  ///< first point of each cell, and the end
  double x_min_ = 0.0, y_min_ = 0.0, cell_ = 1.0;
  int rows_ = 1, row_cells_ = 1;
};

}  // namespace scree::fractal
