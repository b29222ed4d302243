#pragma once
// Moving a plane by whole cells.

#include <algorithm>
#include <cstring>

namespace scree::fractal {

/// What was at (r + down, c + right) comes to (r, c); the rest becomes `fill`. `row_of(r)` is the address of the first
/// of `columns` values of row r; |down| < rows, |right| < columns.
template <class T, class RowOf>
void scroll_plane(const RowOf& row_of, int rows, int columns, int down, int right, T fill) {
  const int first = std::max(0, -right), kept = columns - std::abs(right);
  for (int i = 0; i < rows; ++i) {
    const int r = down >= 0 ? i : rows - 1 - i;  // never over a row that is still to be read
    T* to = row_of(r);
    if (r + down < 0 || r + down >= rows) {
      std::fill_n(to, columns, fill);
      continue;
    }
    std::memmove(to + first, row_of(r + down) + first + right, static_cast<std::size_t>(kept) * sizeof(T));
    std::fill_n(to, first, fill);
    std::fill_n(to + first + kept, columns - first - kept, fill);
  }
}

}  // namespace scree::fractal
