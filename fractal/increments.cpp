#include "fractal/increments.hpp"

#include <algorithm>
#include <cmath>

#include "core/simd.hpp"

namespace scree::fractal {
namespace {

// Without __restrict the sums might be the heights for all that g++ knows, and the loops stay scalar.
SCREE_CLONES void add_three_point(const float* __restrict z, const float* __restrict m, std::ptrdiff_t step, int n,
                                  float* __restrict energy, float* __restrict count) {
  for (int i = 0; i < n; ++i) {
    const float weight = m[i - step] * m[i] * m[i + step];
    const float change = (z[i - step] - z[i]) + (z[i + step] - z[i]);
    energy[i] += weight * (change * change);
    count[i] += weight;
  }
}

SCREE_CLONES void add_square(const float* __restrict z, const float* __restrict m, int step, std::ptrdiff_t down, int n,
                             float* __restrict energy, float* __restrict count) {
  for (int i = 0; i < n; ++i) {
    const float weight = (m[i] * m[i + step]) * (m[i + down] * m[i + down + step]);
    const float change = (z[i] - z[i + step]) - (z[i + down] - z[i + down + step]);
    energy[i] += weight * (change * change);
    count[i] += weight;
  }
}

}  // namespace

std::vector<Increment> IncrementClass::increments() const {
  const int h = step;
  const auto three = [](int dx, int dy) { return Increment{{-dx, -dy, 1}, {0, 0, -2}, {dx, dy, 1}}; };
  switch (shape) {
    case IncrementShape::axis:
      return {three(h, 0), three(0, h)};
    case IncrementShape::diagonal:
      return {three(h, h), three(h, -h)};
    case IncrementShape::square:
      break;
  }
  const int low = -(h / 2), high = low + h;  // no centre cell for odd h: the corner at −⌊h/2⌋
  return {{{low, low, 1}, {high, low, -1}, {low, high, -1}, {high, high, 1}}};
}

void MaskedHeights::clear(int grid_rows, int grid_columns) {
  rows = grid_rows;
  columns = grid_columns;
  const auto cells = static_cast<std::size_t>(rows + 2 * kIncrementReach) * static_cast<std::size_t>(stride());
  height.assign(cells, 0.0F);
  mask.assign(cells, 0.0F);
}

void load_heights(const Grid<float>& height_m, MaskedHeights& out) {
  out.clear(height_m.rows(), height_m.columns());
  for (int r = 0; r < out.rows; ++r) {
    const auto row = height_m.row(r);
    float* height = out.height.data() + out.offset(r, 0);
    float* mask = out.mask.data() + out.offset(r, 0);
    for (std::size_t i = 0; i < row.size(); ++i) {
      const bool known = std::isfinite(row[i]);
      height[i] = known ? row[i] : 0.0F;
      mask[i] = known ? 1.0F : 0.0F;
    }
  }
}

double rounding_variance_m2(float largest_m) {
  if (!(largest_m > 0.0F)) return 0.0;
  const double unit_m = std::ldexp(1.0, std::ilogb(largest_m) - 23);
  return unit_m * unit_m / 12.0;
}

void increment_energies(const MaskedHeights& z, IncrementClass increment_class, int direction, int row, int begin,
                        int end, std::span<float> energy, std::span<float> count) {
  const std::ptrdiff_t stride = z.stride();
  const int n = end - begin, h = increment_class.step;
  const float* height = z.height.data() + z.offset(row, begin);
  const float* mask = z.mask.data() + z.offset(row, begin);
  float* e = energy.data() + begin;
  float* k = count.data() + begin;
  std::fill_n(e, n, 0.0F);
  std::fill_n(k, n, 0.0F);
  if (increment_class.shape == IncrementShape::square) {
    const std::ptrdiff_t corner = -(h / 2) * (stride + 1);
    add_square(height + corner, mask + corner, h, h * stride, n, e, k);
    return;
  }
  const bool axis = increment_class.shape == IncrementShape::axis;
  if (direction != 1) add_three_point(height, mask, axis ? h : h * stride + h, n, e, k);
  if (direction != 0) add_three_point(height, mask, axis ? h * stride : h * stride - h, n, e, k);
}

}  // namespace scree::fractal
