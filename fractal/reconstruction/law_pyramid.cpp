#include "fractal/reconstruction/law_pyramid.hpp"

#include <algorithm>
#include <cmath>

#include "core/simd.hpp"
#include "fractal/lanes.hpp"

namespace scree::fractal {
namespace {

std::int32_t floor_to(std::int32_t value, std::int32_t block) {
  const std::int32_t rest = value % block;
  return value - (rest < 0 ? rest + block : rest);
}

void halve(const Grid<float>& fine, Grid<float>& coarse) {
  const int rows = fine.rows() / 2, columns = fine.columns() / 2;
  if (coarse.rows() != rows || coarse.columns() != columns) coarse.assign(rows, columns, 0.0F);
  for (int r = 0; r < rows; ++r) {
    const float *a = fine.row(2 * r).data(), *b = fine.row(2 * r + 1).data();
    float* out = coarse.row(r).data();
    for (int c = 0; c < columns; ++c) out[c] = 0.25F * ((a[2 * c] + a[2 * c + 1]) + (b[2 * c] + b[2 * c + 1]));
  }
}

SCREE_CLONES void blend3(float side, const float* __restrict a, const float* __restrict b, const float* __restrict c,
                         float* __restrict out, int n) {
  const float centre = 1.0F - 2.0F * side;
  for (int i = 0; i < n; ++i) out[i] = side * (a[i] + c[i]) + centre * b[i];
}

/// One pass of (side, 1 − 2 side, side) along both axes.
void smooth_once(Grid<float>& grid, float side, Grid<float>& scratch) {
  const int rows = grid.rows(), n = grid.columns();
  if (scratch.rows() != rows || scratch.columns() != n) scratch.assign(rows, n, 0.0F);
  for (int r = 0; r < rows; ++r)
    blend3(side, grid.row(std::max(r - 1, 0)).data(), grid.row(r).data(), grid.row(std::min(r + 1, rows - 1)).data(),
           scratch.row(r).data(), n);
  if (n < 2) return std::swap(grid, scratch);
  for (int r = 0; r < rows; ++r) {
    const float* in = scratch.row(r).data();
    float* out = grid.row(r).data();
    blend3(side, in, in + 1, in + 2, out + 1, n - 2);
    out[0] = (1.0F - side) * in[0] + side * in[1];
    out[n - 1] = (1.0F - side) * in[n - 1] + side * in[n - 2];
  }
}

SCREE_CLONES void law_row(const float* __restrict dimension, const float* __restrict amplitude, float log_cell,
                          float log_unit, float* __restrict hurst, float* __restrict log_sigma, int n) {
  for (int i = 0; i < n; ++i) {
    const float h = 3.0F - std::min(std::max(dimension[i], 2.05F), 2.95F);
    float log_amplitude;
    fast_log<float, std::int32_t>(std::max(amplitude[i], 1e-12F), log_amplitude);
    hurst[i] = h;
    log_sigma[i] = log_amplitude + h * log_cell - log_unit;
  }
}

}  // namespace

void smooth_little(Grid<float>& grid, float variance, Grid<float>& scratch) {
  smooth_once(grid, 0.5F * variance, scratch);
}

void smooth_two(Grid<float>& grid, Grid<float>& scratch) {
  for (int pass = 0; pass < 4; ++pass) smooth_once(grid, 0.25F, scratch);
}

/// Row `row` of level 0, copies of the border beyond the window.
void LawPyramid::load_row(const LawMap& law, const LatticeWindow& window, double unit_m, double cell_m, int row) {
  const int from = std::clamp(start_.y + row - window.min.y, 0, window.rows - 1);
  const int before = window.min.x - start_.x, total = levels_[0].hurst.columns();
  float *log_sigma = levels_[0].log_sigma.row(row).data(), *hurst = levels_[0].hurst.row(row).data();
  law_row(law.dimension.row(from).data(), law.amplitude_m.row(from).data(), static_cast<float>(std::log(cell_m)),
          static_cast<float>(std::log(unit_m)), hurst + before, log_sigma + before, window.columns);
  for (float* values : {log_sigma, hurst}) {
    std::fill_n(values, before, values[before]);
    std::fill(values + before + window.columns, values + total, values[before + window.columns - 1]);
  }
}

void LawPyramid::build(const LawMap& law, const LatticeWindow& window, double unit_m, double cell_m, int levels) {
  const std::int32_t block = 1 << (levels - 1);
  start_ = {floor_to(window.min.x, block), floor_to(window.min.y, block)};
  const int columns = floor_to(window.min.x + window.columns + block - 1, block) - start_.x;
  const int rows = floor_to(window.min.y + window.rows + block - 1, block) - start_.y;
  levels_.resize(static_cast<std::size_t>(levels));
  for (Grid<float>* grid : {&levels_[0].log_sigma, &levels_[0].hurst})
    if (grid->rows() != rows || grid->columns() != columns) grid->assign(rows, columns, 0.0F);
  for (int r = 0; r < rows; ++r) load_row(law, window, unit_m, cell_m, r);
  for (std::size_t g = 1; g < levels_.size(); ++g) {
    halve(levels_[g - 1].log_sigma, levels_[g].log_sigma);
    halve(levels_[g - 1].hurst, levels_[g].hurst);
  }
}

}  // namespace scree::fractal
