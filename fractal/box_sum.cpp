#include "fractal/box_sum.hpp"

#include <algorithm>

#include "core/simd.hpp"

namespace scree::fractal {
namespace {

SCREE_CLONES void add(float* __restrict out, const float* __restrict in, std::size_t n) {
  for (std::size_t i = 0; i < n; ++i) out[i] += in[i];
}

SCREE_CLONES void add_pairs(const float* __restrict cell, float* __restrict out, std::size_t step, std::size_t n) {
  for (std::size_t i = 0; i < n; ++i) out[i] = cell[i] + cell[i + step];
}

/// The same in place, front to back: reads stay ahead of writes.
SCREE_CLONES void fold(float* cell, std::size_t step, std::size_t n) {
  for (std::size_t i = 0; i < n; ++i) cell[i] += cell[i + step];
}

/// out[i] = Σ cell[i … i + width) for i < n; `cell` holds n + width − 1 values of `stride` floats each, `folded` has
/// room for as many. Widths are odd.
void windowed(const float* cell, float* folded, float* out, std::size_t n, std::size_t width, std::size_t stride) {
  std::copy_n(cell, n * stride, out);
  std::size_t taken = 1, held = n + width - 1;
  // After each turn folded[i] = Σ of the next `span` values.
  for (std::size_t span = 2; span <= width; span *= 2) {
    held -= span / 2;
    if (span == 2)
      add_pairs(cell, folded, stride, held * stride);
    else
      fold(folded, span / 2 * stride, held * stride);
    if (width & span) {
      add(out, folded + taken * stride, n * stride);
      taken += span;
    }
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
  sums_.assign(rows, columns, 0.0F);
}

void BoxSum::sum(BoxScratch& scratch) {
  const auto margin = static_cast<std::size_t>(radius_);
  const std::size_t width = 2 * margin + 1, columns = static_cast<std::size_t>(columns_), line = columns + 2 * margin;
  scratch.plane.resize(std::max(scratch.plane.size(), plane_.size()));
  scratch.folded.resize(std::max(scratch.folded.size(), line));
  scratch.line.assign(line, 0.0F);
  windowed(plane_.data(), scratch.plane.data(), sums_.data(), static_cast<std::size_t>(rows_), width, columns);
  for (int r = 0; r < rows_; ++r) {
    const auto row = sums_.row(r);
    std::copy(row.begin(), row.end(), scratch.line.begin() + radius_);
    windowed(scratch.line.data(), scratch.folded.data(), row.data(), columns, width, 1);
  }
}

}  // namespace scree::fractal
