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

using Place = VaryingPrior::Place;

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

}  // namespace

void VaryingPrior::spread(const Grid<float>& blocks, CellIndex offset, PaddedField& out) {
  line_.resize(static_cast<std::size_t>(blocks.columns()) + 1);
  places_.resize(static_cast<std::size_t>(out.columns()));
  for (int c = 0; c < out.columns(); ++c)
    places_[static_cast<std::size_t>(c)] = place_of(c + offset.x, blocks.columns());
  for (int r = 0; r < out.rows(); ++r) {
    const auto [j, share] = place_of(r + offset.y, blocks.rows());
    blend(share, blocks.row(j).data(), blocks.row(std::min(j + 1, blocks.rows() - 1)).data(), line_.data(),
          blocks.columns());
    line_.back() = line_[line_.size() - 2];
    gather(line_.data(), places_.data(), out.row(r), out.columns());
  }
}

double VaryingPrior::set(const LawMap& law, const LatticeWindow& window, const PriorScale& scale,
                         const MultigridShape& shape, BlendField& prior) {
  pyramid_.build(law, window, scale.unit_m, scale.cell_m, kBlockLevels);
  log_sigma_ = pyramid_.level(kBlockLevels - 1).log_sigma;
  hurst_ = pyramid_.level(kBlockLevels - 1).hurst;
  for (Grid<float>* grid : {&log_sigma_, &hurst_})
    for (int pass = 0; pass < 2; ++pass) smooth_two(*grid, scratch_);
  const WeightTable table(scale.spacing_cells);
  for (Grid<float>* weights : {&w1_, &w2_}) weights->assign(hurst_.rows(), hurst_.columns(), 0.0F);
  float smoothest = 3.0F;
  for (std::size_t i = 0; i < hurst_.size(); ++i) {
    const BlendWeights w = table.at(3.0F - hurst_[i], log_sigma_[i]);
    w1_[i] = w.w1;
    w2_[i] = w.w2;
    smoothest = std::min(smoothest, 3.0F - hurst_[i]);
  }
  prior.w1.reshape(shape.rows, shape.columns);
  prior.w2.reshape(shape.rows, shape.columns);
  const CellIndex offset{window.min.x - pyramid_.start().x, window.min.y - pyramid_.start().y};
  spread(w1_, offset, prior.w1);
  spread(w2_, offset, prior.w2);
  return static_cast<double>(smoothest);
}

}  // namespace scree::fractal
