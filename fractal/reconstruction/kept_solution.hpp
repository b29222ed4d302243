#pragma once
// A solution of the last frame, for the next one to start from.

#include <algorithm>

#include "core/grid.hpp"
#include "fractal/reconstruction/padded_field.hpp"

namespace scree::fractal {

/// Values in metres and where they lie on the lattice.
struct KeptSolution {
  CellIndex min;
  PaddedField values;
  bool valid = false;

  bool overlaps(CellIndex other, int rows, int columns) const {
    return valid && other.x < min.x + values.columns() && min.x < other.x + columns &&
           other.y < min.y + values.rows() && min.y < other.y + rows;
  }
  /// Row `r` of a window at `to`, new cells from the nearest old one.
  void shifted_row(CellIndex to, int r, int columns, float* out) const {
    const float* row = values.row(std::clamp(to.y + r - min.y, 0, values.rows() - 1));
    const int shift = to.x - min.x, last = values.columns() - 1;
    const int begin = std::clamp(-shift, 0, columns), end = std::clamp(last + 1 - shift, begin, columns);
    std::fill_n(out, begin, row[0]);
    std::copy_n(row + begin + shift, end - begin, out + begin);
    std::fill_n(out + end, columns - end, row[last]);
  }
};

}  // namespace scree::fractal
