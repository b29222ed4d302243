#pragma once
// Sums over (2·radius + 1)² windows by doubling: only additions, so nothing is left of a large value once it is outside
// the window (running sums leave its rounding), and a sum depends neither on how the work is cut nor on where the
// window stands.

#include <vector>

#include "core/grid.hpp"

namespace scree::fractal {

/// Work space, one per thread of use; any BoxSum of any shape may use it.
struct BoxScratch {
  std::vector<float> plane, line, folded;
};

/// One plane and its window sums. Fill `row(r)` for every row, then `sum`; the rows stay. Buffers are reused.
class BoxSum {
 public:
  /// All values become 0.
  void resize(int rows, int columns, int radius);
  std::span<float> row(int r) {
    return {plane_.data() + static_cast<std::size_t>(r + radius_) * static_cast<std::size_t>(columns_),
            static_cast<std::size_t>(columns_)};
  }
  /// Windows are cut at the border. Cost: about 2·log2(2·radius + 1) additions a cell, no allocation once the scratch
  /// has grown.
  void sum(BoxScratch& scratch);
  const Grid<float>& sums() const { return sums_; }
  Grid<float>& sums() { return sums_; }

 private:
  int rows_ = 0, columns_ = 0, radius_ = 0;
  std::vector<float> plane_;  // rows + 2·radius; the margins are 0
  Grid<float> sums_;
};

}  // namespace scree::fractal
