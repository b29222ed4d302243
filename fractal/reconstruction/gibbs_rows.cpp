#include "fractal/reconstruction/gibbs_rows.hpp"

#include <algorithm>
#include <cmath>

#include "core/simd.hpp"
#include "fractal/reconstruction/normal_rows.hpp"

namespace scree::fractal {
namespace {

int reflected(int i, int n) {
  const int period = 2 * n, m = ((i % period) + period) % period;
  return m < n ? m : period - 1 - m;
}

/// Of one phase in one row: neighbours by offset, the cell's own numbers.
struct PhaseRow {
  const float *left2, *left, *right, *right2;
  const float *up2, *up, *down, *down2;
  const float *up_left, *up_right, *down_left, *down_right;
  const float *precision, *rhs, *variance, *deviation;
};

/// x may be its own neighbour above or below (at the border): only at the same index, which is read first.
SCREE_CLONES void update_phase(const PhaseRow& p, float w1, float w2, const float* normals, int n, float* x) {
  const float centre = 4.0F * w1 + 20.0F * w2, side = -w1 - 8.0F * w2, diagonal = 2.0F * w2;
  const float *left2 = p.left2, *left = p.left, *right = p.right, *right2 = p.right2, *up2 = p.up2, *up = p.up,
              *down = p.down, *down2 = p.down2, *up_left = p.up_left, *up_right = p.up_right, *down_left = p.down_left,
              *down_right = p.down_right, *precision = p.precision, *rhs = p.rhs, *variance = p.variance,
              *deviation = p.deviation;
#pragma GCC ivdep
  for (int j = 0; j < n; ++j) {
    const float sides = (left[j] + right[j]) + (up[j] + down[j]);
    const float diagonals = (up_left[j] + up_right[j]) + (down_left[j] + down_right[j]);
    const float fars = (left2[j] + right2[j]) + (up2[j] + down2[j]);
    const float pull = rhs[j] - ((centre + precision[j]) * x[j] + side * sides + diagonal * diagonals + w2 * fars);
    x[j] += variance[j] * pull + deviation[j] * normals[j];
  }
}

}  // namespace

void PhaseField::resize(int rows, int columns) {
  rows_ = rows;
  columns_ = columns;
  width_ = (columns + 1) / 3 + 2;
  cells_.assign(static_cast<std::size_t>(rows) * 3 * static_cast<std::size_t>(width_), 0.0F);
}

void PhaseField::load(const Grid<float>& values) {
  resize(values.rows(), values.columns());
  for (int r = 0; r < rows_; ++r) {
    for (int c = 0; c < columns_; ++c) at(r, c) = values(r, c);
    reflect(r);
  }
}

void PhaseField::store(Grid<float>& values) const {
  values.assign(rows_, columns_, 0.0F);
  for (int r = 0; r < rows_; ++r)
    for (int c = 0; c < columns_; ++c) values(r, c) = phase(r, c % 3)[c / 3];
}

void PhaseField::reflect(int row) {
  for (const int c : {-2, -1, columns_, columns_ + 1}) at(row, c) = at(row, reflected(c, columns_));
}

GibbsRows::GibbsRows(const GibbsLevel& level) : weights_(level.weights) {
  precision_.load(level.precision);
  right_.load(level.right);
  variance_.load(level.variance);
  Grid<float> deviation = level.variance;
  for (float& value : deviation) value = std::sqrt(value);
  deviation_.load(deviation);
  const int lanes = (3 * precision_.count(0) + 3) / 4;
  normals_.assign(4 * static_cast<std::size_t>(lanes), 0.0F);
}

void GibbsRows::sweep(const SweepNoise* noise, PhaseField& x) {
  const int rows = x.rows(), count = x.count(0);
  if (noise == nullptr) std::fill(normals_.begin(), normals_.end(), 0.0F);
  for (int r = 0; r < rows; ++r) {
    if (noise != nullptr)
      normal_block(noise->seed, noise->stream, r, static_cast<int>(normals_.size() / 4), normals_.data());
    for (int p = 0; p < 3; ++p) {
      // column c + d is in phase (p + d) mod 3, at j − 1, j or j + 1
      const auto at = [&](int dy, int d) {
        const int shifted = p + d + 3;
        return x.phase(reflected(r + dy, rows), shifted % 3) + (shifted / 3 - 1);
      };
      const PhaseRow row = {at(0, -2),
                            at(0, -1),
                            at(0, 1),
                            at(0, 2),
                            at(-2, 0),
                            at(-1, 0),
                            at(1, 0),
                            at(2, 0),
                            at(-1, -1),
                            at(-1, 1),
                            at(1, -1),
                            at(1, 1),
                            precision_.phase(r, p),
                            right_.phase(r, p),
                            variance_.phase(r, p),
                            deviation_.phase(r, p)};
      update_phase(row, weights_.w1, weights_.w2, normals_.data() + static_cast<std::ptrdiff_t>(p) * count, x.count(p),
                   x.phase(r, p));
      x.reflect(r);
    }
  }
}

}  // namespace scree::fractal
