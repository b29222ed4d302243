#include "fractal/reconstruction/varying_prior.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/simd.hpp"

namespace scree::fractal {
namespace {

constexpr int kBlockLevels = 3;  // blocks of 4 cells
constexpr int kBlock = 1 << (kBlockLevels - 1);

/// log w1 and log w2 as functions of D.
class WeightTable {
 public:
  explicit WeightTable(double spacing_cells) {
    for (std::size_t i = 0; i < kNodes; ++i) {
      const double dimension = kFirst + kStep * static_cast<double>(i);
      const BlendWeights w = blend_weights(dimension, blend_wavenumber(dimension, spacing_cells));
      log_w1_[i] = std::log(w.w1);
      log_w2_[i] = std::log(w.w2);
    }
  }
  BlendWeights at(float dimension, float log_sigma) const {
    const float position = std::clamp((dimension - kFirst) / kStep, 0.0F, static_cast<float>(kNodes - 1));
    const auto node = std::min(static_cast<std::size_t>(position), kNodes - 2);
    const float t = position - static_cast<float>(node);
    return {std::exp(log_w1_[node] + t * (log_w1_[node + 1] - log_w1_[node]) - 2.0F * log_sigma),
            std::exp(log_w2_[node] + t * (log_w2_[node + 1] - log_w2_[node]) - 2.0F * log_sigma)};
  }

 private:
  static constexpr float kFirst = 2.05F, kStep = 0.0125F;
  static constexpr std::size_t kNodes = 73;  // to 2.95
  std::array<float, kNodes> log_w1_, log_w2_;
};

/// Weights at the middles of blocks, spread over the cells.
struct Blocks {
  Grid<float> w1, w2;
};

/// Where a cell lies between the middles of blocks.
struct Place {
  int below;
  float share;
};
Place place_of(int cell, int blocks) {
  const float position = (static_cast<float>(cell) + 0.5F) / kBlock - 0.5F;
  const int below = std::clamp(static_cast<int>(std::floor(position)), 0, std::max(blocks - 2, 0));
  return {below, std::clamp(position - static_cast<float>(below), 0.0F, 1.0F)};
}

SCREE_CLONES void blend(float share, const float* __restrict a, const float* __restrict b, float* __restrict out,
                        int n) {
  for (int i = 0; i < n; ++i) out[i] = a[i] + share * (b[i] - a[i]);
}

SCREE_CLONES void gather(const float* __restrict line, const Place* __restrict places, float* __restrict out, int n) {
  for (int i = 0; i < n; ++i) {
    const float left = line[places[i].below];
    out[i] = left + places[i].share * (line[places[i].below + 1] - left);
  }
}

void spread(const Grid<float>& blocks, CellIndex offset, PaddedField& out) {
  std::vector<float> line(static_cast<std::size_t>(blocks.columns()) + 1);
  std::vector<Place> places(static_cast<std::size_t>(out.columns()));
  for (int c = 0; c < out.columns(); ++c)
    places[static_cast<std::size_t>(c)] = place_of(c + offset.x, blocks.columns());
  for (int r = 0; r < out.rows(); ++r) {
    const auto [j, share] = place_of(r + offset.y, blocks.rows());
    blend(share, blocks.row(j).data(), blocks.row(std::min(j + 1, blocks.rows() - 1)).data(), line.data(),
          blocks.columns());
    line.back() = line[line.size() - 2];
    gather(line.data(), places.data(), out.row(r), out.columns());
  }
}

}  // namespace

double varying_prior(const LawMap& law, const LatticeWindow& window, const PriorScale& scale,
                     const MultigridShape& shape, BlendField& prior) {
  LawPyramid pyramid;
  pyramid.build(law, window, scale.unit_m, scale.cell_m, kBlockLevels);
  Grid<float> log_sigma = pyramid.level(kBlockLevels - 1).log_sigma, hurst = pyramid.level(kBlockLevels - 1).hurst;
  Grid<float> scratch;
  for (Grid<float>* grid : {&log_sigma, &hurst})
    for (int pass = 0; pass < 2; ++pass) smooth_two(*grid, scratch);
  const WeightTable table(scale.spacing_cells);
  Blocks blocks{log_sigma, log_sigma};
  float smoothest = 3.0F;
  for (std::size_t i = 0; i < hurst.size(); ++i) {
    const BlendWeights w = table.at(3.0F - hurst[i], log_sigma[i]);
    blocks.w1[i] = w.w1;
    blocks.w2[i] = w.w2;
    smoothest = std::min(smoothest, 3.0F - hurst[i]);
  }
  prior.w1.reshape(shape.rows, shape.columns);
  prior.w2.reshape(shape.rows, shape.columns);
  const CellIndex offset{window.min.x - pyramid.start().x, window.min.y - pyramid.start().y};
  spread(blocks.w1, offset, prior.w1);
  spread(blocks.w2, offset, prior.w2);
  return static_cast<double>(smoothest);
}

}  // namespace scree::fractal
