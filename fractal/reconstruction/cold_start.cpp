#include "fractal/reconstruction/cold_start.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/grid.hpp"
#include "core/simd.hpp"

namespace scree::fractal {
namespace {

/// Where a cell lies between the middles of blocks.
struct Place {
  int below;
  float share;
};

Place place_of(int cell, int block, int blocks) {
  const float position = (static_cast<float>(cell) + 0.5F) / static_cast<float>(block) - 0.5F;
  const int below = std::clamp(static_cast<int>(std::floor(position)), 0, blocks - 2);
  return {below, std::clamp(position - static_cast<float>(below), 0.0F, 1.0F)};
}

SCREE_CLONES void add_row(const float* __restrict a, float* __restrict sum, int n) {
  for (int i = 0; i < n; ++i) sum[i] += a[i];
}

SCREE_CLONES void blend_row(float share, const float* __restrict a, const float* __restrict b, float* __restrict out,
                            int n) {
  for (int i = 0; i < n; ++i) out[i] = a[i] + share * (b[i] - a[i]);
}

SCREE_CLONES void gather_row(const float* __restrict line, const Place* __restrict places, float* __restrict out,
                             int n) {
  for (int i = 0; i < n; ++i) {
    const float left = line[places[i].below];
    out[i] = left + places[i].share * (line[places[i].below + 1] - left);
  }
}

/// Of whole blocks; what is left over at the far borders belongs to none.
Grid<float> block_means(const PaddedField& u, int block) {
  Grid<float> means(u.rows() / block, u.columns() / block);
  std::vector<float> sums(static_cast<std::size_t>(u.columns()));
  const float scale = 1.0F / static_cast<float>(block * block);
  for (int r = 0; r < means.rows(); ++r) {
    std::fill(sums.begin(), sums.end(), 0.0F);
    for (int i = 0; i < block; ++i) add_row(u.row(r * block + i), sums.data(), u.columns());
    for (int c = 0; c < means.columns(); ++c) {
      float sum = 0.0F;
      for (int i = 0; i < block; ++i) sum += sums[static_cast<std::size_t>(c * block + i)];
      means(r, c) = scale * sum;
    }
  }
  return means;
}

}  // namespace

void start_from_means(const PaddedField& u, double spacing_cells, PaddedField& x) {
  int block = 1 << std::clamp(static_cast<int>(std::lround(std::log2(2.0 * spacing_cells))), 0, 10);
  while (block > 1 && 2 * block > std::min(u.rows(), u.columns())) block /= 2;
  const Grid<float> means = block_means(u, block);
  std::vector<float> line(static_cast<std::size_t>(means.columns()));
  std::vector<Place> places(static_cast<std::size_t>(u.columns()));
  for (int c = 0; c < u.columns(); ++c) places[static_cast<std::size_t>(c)] = place_of(c, block, means.columns());
  x.reshape(u.rows(), u.columns());
  for (int r = 0; r < u.rows(); ++r) {
    const Place down = place_of(r, block, means.rows());
    blend_row(down.share, means.row(down.below).data(), means.row(down.below + 1).data(), line.data(), means.columns());
    gather_row(line.data(), places.data(), x.row(r), u.columns());
  }
}

}  // namespace scree::fractal
