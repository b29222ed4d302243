#include "mapping/terrain_shape.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/executor.hpp"
#include "core/simd.hpp"

namespace scree::mapping {

namespace {

constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();
constexpr float kCellsForPlane = 5.0F;
constexpr float kFaceVariances = 12.0F;  // height² of an evenly sampled face over its variance
constexpr float kNoiseVariances = 4.0F;  // a difference within two of its standard deviations is no step

// best = max(best, (there − here)² − noise); comparisons with NaN keep what is there.
SCREE_CLONES void raise_step(const float* here, const float* here_variance, const float* there,
                             const float* there_variance, int n, float* best) {
  for (int x = 0; x < n; ++x) {
    const float d = there[x] - here[x];
    const float square = d * d - kNoiseVariances * (here_variance[x] + there_variance[x]);
    best[x] = square > best[x] ? square : best[x];
  }
}

// Moments about column x of the cells x − radius … x + radius.
SCREE_CLONES void row_moments(const float* __restrict known, const float* __restrict z, int radius, int n,
                              float* __restrict sum, float* __restrict sum_x, float* __restrict sum_xx,
                              float* __restrict sum_z, float* __restrict sum_zx) {
  for (int offset = -radius; offset <= radius; ++offset) {
    const auto o = static_cast<float>(offset);
    for (int x = 0; x < n; ++x) {
      const float w = known[x + offset];
      const float h = z[x + offset];
      sum[x] += w;
      sum_x[x] += w * o;
      sum_xx[x] += w * o * o;
      sum_z[x] += h;
      sum_zx[x] += h * o;
    }
  }
}

struct Moments {
  float n = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0, z = 0, zx = 0, zy = 0;
};

// Rise over run of the least-squares plane about a cell, per cell; NaN when it is not determined.
float gradient(const Moments& m) {
  if (m.n < kCellsForPlane) return kUnknown;
  const float mean_x = m.x / m.n, mean_y = m.y / m.n;
  const float sxx = m.xx - m.x * mean_x, sxy = m.xy - m.x * mean_y, syy = m.yy - m.y * mean_y;
  const float szx = m.zx - m.z * mean_x, szy = m.zy - m.z * mean_y;
  const float determinant = sxx * syy - sxy * sxy;
  if (determinant < 0.25F) return kUnknown;
  const float a = (szx * syy - szy * sxy) / determinant;
  const float b = (szy * sxx - szx * sxy) / determinant;
  return std::sqrt(a * a + b * b);
}

}  // namespace

int TerrainShape::step_reach_cells() const {
  return std::max(static_cast<int>(config_.step_radius_m / config_.cell_m), 1);
}

void TerrainShape::pad(const Grid<float>& elevation_m, Executor& executor) {
  margin_ = std::max(config_.slope_radius_cells, step_reach_cells());
  const int rows = elevation_m.rows() + 2 * margin_;
  const int columns = elevation_m.columns() + 2 * margin_;
  z_.assign(rows, columns, 0.0F);
  known_.assign(rows, columns, 0.0F);
  const auto first = std::find_if(elevation_m.begin(), elevation_m.end(), [](float z) { return std::isfinite(z); });
  const float reference_m = first != elevation_m.end() ? *first : 0.0F;  // sums of small numbers keep their digits
  for_rows(executor, elevation_m.rows(), [&](int begin, int end) {
    for (int row = begin; row < end; ++row)
      for (int column = 0; column < elevation_m.columns(); ++column) {
        const float z = elevation_m(row, column);
        if (!std::isfinite(z)) continue;
        z_(row + margin_, column + margin_) = z - reference_m;
        known_(row + margin_, column + margin_) = 1.0F;
      }
  });
}

void TerrainShape::sum_rows(int row, int columns) {
  for (Grid<float>* grid : {&n_, &nx_, &nxx_, &z0_, &zx_})
    std::fill(grid->row(row).begin(), grid->row(row).end(), 0.0F);
  row_moments(known_.row(row).data() + margin_, z_.row(row).data() + margin_, config_.slope_radius_cells, columns,
              n_.row(row).data(), nx_.row(row).data(), nxx_.row(row).data(), z0_.row(row).data(), zx_.row(row).data());
}

void TerrainShape::fit_row(const Grid<float>& elevation_m, int row, Grid<float>& slope_rad) {
  const int radius = config_.slope_radius_cells;
  const auto cell_m = static_cast<float>(config_.cell_m);
  for (int column = 0; column < elevation_m.columns(); ++column) {
    if (!std::isfinite(elevation_m(row, column))) continue;
    Moments m;
    for (int offset = -radius; offset <= radius; ++offset) {
      const int from = row + margin_ + offset;
      const auto o = static_cast<float>(offset);
      m.n += n_(from, column);
      m.x += nx_(from, column);
      m.xx += nxx_(from, column);
      m.z += z0_(from, column);
      m.zx += zx_(from, column);
      m.y += o * n_(from, column);
      m.yy += o * o * n_(from, column);
      m.xy += o * nx_(from, column);
      m.zy += o * z0_(from, column);
    }
    slope_rad(row, column) = std::atan(gradient(m) / cell_m);
  }
}

void TerrainShape::slopes(const Grid<float>& elevation_m, Executor& executor, Grid<float>& slope_rad) {
  const int columns = elevation_m.columns();
  pad(elevation_m, executor);
  slope_rad.assign(elevation_m.rows(), columns, kUnknown);
  for (Grid<float>* grid : {&n_, &nx_, &nxx_, &z0_, &zx_})
    if (grid->rows() != z_.rows() || grid->columns() != columns) grid->assign(z_.rows(), columns, 0.0F);
  for_rows(executor, z_.rows(), [&](int begin, int end) {
    for (int row = begin; row < end; ++row) sum_rows(row, columns);
  });
  for_rows(executor, elevation_m.rows(), [&](int begin, int end) {
    for (int row = begin; row < end; ++row) fit_row(elevation_m, row, slope_rad);
  });
}

void TerrainShape::step_row(const Grid<float>& relief_m2, int row, std::span<float> best) const {
  const int reach = step_reach_cells();
  const double radius_cells = std::max(config_.step_radius_m / config_.cell_m, 1.0);
  const int columns = static_cast<int>(best.size());
  const float* here = z_.row(row + margin_).data() + margin_;
  const float* here_variance = variance_.row(row + margin_).data() + margin_;
  for (int dy = -reach; dy <= reach; ++dy)
    for (int dx = -reach; dx <= reach; ++dx)
      if (dx * dx + dy * dy <= radius_cells * radius_cells)
        raise_step(here, here_variance, z_.row(row + margin_ + dy).data() + margin_ + dx,
                   variance_.row(row + margin_ + dy).data() + margin_ + dx, columns, best.data());
  for (int column = 0; column < columns; ++column) {
    float& step = best[static_cast<std::size_t>(column)];
    const bool known = known_(row + margin_, column + margin_) != 0.0F;
    step = known ? std::sqrt(std::max(step, kFaceVariances * relief_m2(row, column))) : kUnknown;
  }
}

void TerrainShape::steps(const Grid<float>& elevation_m, const Grid<float>& variance_m2, const Grid<float>& relief_m2,
                         Executor& executor, Grid<float>& step_m) {
  variance_.assign(z_.rows(), z_.columns(), 0.0F);
  step_m.assign(elevation_m.rows(), elevation_m.columns(), 0.0F);
  for_rows(executor, z_.rows(), [&](int begin, int end) {  // unknown cells: 0 in sums so far, NaN in differences
    for (int row = begin; row < end; ++row)
      for (int column = 0; column < z_.columns(); ++column)
        if (known_(row, column) == 0.0F)
          z_(row, column) = kUnknown;
        else
          variance_(row, column) = variance_m2(row - margin_, column - margin_);
  });
  for_rows(executor, elevation_m.rows(), [&](int begin, int end) {
    for (int row = begin; row < end; ++row) step_row(relief_m2, row, step_m.row(row));
  });
}

void TerrainShape::update(const Grid<float>& elevation_m, const Grid<float>& variance_m2, const Grid<float>& relief_m2,
                          Executor& executor, Grid<float>& slope_rad, Grid<float>& step_m) {
  slopes(elevation_m, executor, slope_rad);
  steps(elevation_m, variance_m2, relief_m2, executor, step_m);
}

}  // namespace scree::mapping
