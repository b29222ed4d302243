#include "fractal/box_sum.hpp"

#include <algorithm>

#include "core/simd.hpp"

namespace scree::fractal {
namespace {

SCREE_CLONES void add(float* __restrict out, const float* __restrict in, std::size_t n) {
  for (std::size_t i = 0; i < n; ++i) out[i] += in[i];
}

/// cell[i] += cell[i + step], front to back: reads stay ahead of writes.
SCREE_CLONES void fold(float* cell, std::size_t step, std::size_t n) {
  for (std::size_t i = 0; i < n; ++i) cell[i] += cell[i + step];
}

/// out[i] = Σ cell[i … i + width) for i < n; `cell` holds n + width − 1 values of `stride` floats each and is
/// destroyed.
void windowed(float* cell, float* out, std::size_t n, std::size_t width, std::size_t stride) {
  std::fill_n(out, n * stride, 0.0F);
  std::size_t taken = 0, held = n + width - 1;
  for (std::size_t span = 1; span <= width; span *= 2) {  // cell[i] = Σ of the next `span` values
    if (width & span) {
      add(out, cell + taken * stride, n * stride);
      taken += span;
    }
    if (2 * span > width) break;
    held -= span;
    fold(cell, span * stride, held * stride);
  }
}

}  // namespace

void BoxSum::resize(int rows, int columns, int radius) {
  rows_ = rows;
  columns_ = columns;
  radius_ = radius;
  plane_.assign(
      (static_cast<std::size_t>(rows) + 2 * static_cast<std::size_t>(radius)) * static_cast<std::size_t>(columns),
      0.0F);
  line_.assign(static_cast<std::size_t>(columns) + 2 * static_cast<std::size_t>(radius), 0.0F);
  sums_.assign(rows, columns, 0.0F);
}

void BoxSum::sum() {
  const auto margin = static_cast<std::size_t>(radius_);
  const std::size_t width = 2 * margin + 1, columns = static_cast<std::size_t>(columns_);
  windowed(plane_.data(), sums_.data(), static_cast<std::size_t>(rows_), width, columns);
  for (int r = 0; r < rows_; ++r) {
    const auto row = sums_.row(r);
    std::fill(line_.begin(), line_.begin() + radius_, 0.0F);
    std::copy(row.begin(), row.end(), line_.begin() + radius_);
    std::fill(line_.end() - radius_, line_.end(), 0.0F);
    windowed(line_.data(), row.data(), columns, width, 1);
  }
  // Folding has filled the margin rows: clear them for the next plane.
  std::fill_n(plane_.begin(), margin * columns, 0.0F);
  std::fill(plane_.end() - static_cast<std::ptrdiff_t>(margin * columns), plane_.end(), 0.0F);
}

}  // namespace scree::fractal
