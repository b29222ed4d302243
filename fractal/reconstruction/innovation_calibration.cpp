#include "fractal/reconstruction/innovation_calibration.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <vector>

#include "core/simd.hpp"

namespace scree::fractal {
namespace {

/// E min(χ²₁, limit).
double mean_below(double limit) {
  const double z = std::sqrt(limit), beyond = std::erfc(z / std::numbers::sqrt2);
  return 1.0 - beyond - 2.0 * z * std::exp(-0.5 * limit) / std::sqrt(2.0 * std::numbers::pi) + limit * beyond;
}

/// Σg/Σg² of three boxes, each way alike.
double effective_scale(int radius) {
  std::vector<double> kernel = {1.0};
  const std::size_t width = 2 * static_cast<std::size_t>(radius) + 1;
  for (int box = 0; box < 3; ++box) {
    std::vector<double> next(kernel.size() + width - 1, 0.0);
    for (std::size_t i = 0; i < kernel.size(); ++i)
      for (std::size_t j = 0; j < width; ++j) next[i + j] += kernel[i];
    kernel.swap(next);
  }
  double sum = 0.0, square = 0.0;
  for (const double g : kernel) sum += g, square += g * g;
  return std::pow(sum / square, 2);
}

struct Rule {
  float keep, limit;
};

/// Forgets, then adds the row's news; `sums` and `counts` get a copy to smooth.
SCREE_CLONES void hear_row(const float* __restrict ratio, const float* __restrict factor, Rule rule,
                           float* __restrict sum, float* __restrict count, float* __restrict sums,
                           float* __restrict counts, int n) {
  for (int i = 0; i < n; ++i) {
    const float most = rule.limit * (factor[i] > 1.0F ? factor[i] : 1.0F);
    const float heard = ratio[i] >= 0.0F ? 1.0F : 0.0F;
    const float value = ratio[i] >= 0.0F ? (ratio[i] < most ? ratio[i] : most) : 0.0F;
    sums[i] = sum[i] = rule.keep * sum[i] + value;
    counts[i] = count[i] = rule.keep * count[i] + heard;
  }
}

SCREE_CLONES void weigh_row(const float* __restrict sums, const float* __restrict counts, float prior, float scale,
                            float share, float* __restrict factor, int n) {
  for (int i = 0; i < n; ++i) factor[i] = (prior + share * sums[i]) / (prior + scale * counts[i]);
}

}  // namespace

InnovationCalibration::InnovationCalibration(const InnovationConfig& config)
    : config_(config),
      radius_(BoxCascade::radius_of(config.window_cells)),
      keep_(static_cast<float>(std::exp(-1.0 / config.memory_frames))),
      scale_(static_cast<float>(effective_scale(radius_))),
      share_(static_cast<float>(effective_scale(radius_) / mean_below(config.limit))) {
  assert(config.window_cells > 0.0 && config.prior_cells > 0.0 && config.memory_frames > 0.0 && config.limit > 0.0);
}

/// Copies what both windows hold. Rows are contiguous for the loops of every frame, hence no RollingGrid: moving costs
/// less than a tenth of the smoothing.
void InnovationCalibration::carry(const LatticeWindow& window, float entering, Grid<float>& cells) {
  spare_.assign(window.rows, window.columns, entering);
  const std::int64_t dx = std::int64_t{window.min.x} - window_.min.x, dy = std::int64_t{window.min.y} - window_.min.y;
  const std::int64_t first = std::max<std::int64_t>(0, -dx);
  const std::int64_t n = std::min<std::int64_t>(window.columns, window_.columns - dx) - first;
  const std::int64_t last_row = std::min<std::int64_t>(window.rows, window_.rows - dy);
  for (std::int64_t r = std::max<std::int64_t>(0, -dy); n > 0 && r < last_row; ++r)
    std::copy_n(cells.row(static_cast<int>(r + dy)).begin() + first + dx, n,
                spare_.row(static_cast<int>(r)).begin() + first);
  std::swap(cells, spare_);
}

void InnovationCalibration::follow(const LatticeWindow& window) {
  if (window == window_) return;
  carry(window, 0.0F, sum_);
  carry(window, 0.0F, count_);
  carry(window, 1.0F, factor_);
  window_ = window;
  sums_.resize(window.rows, window.columns, radius_);
  counts_.resize(window.rows, window.columns, radius_);
  if (spare_.size() != factor_.size()) spare_ = factor_;
}

void InnovationCalibration::update(const LatticeWindow& window, const Grid<float>& squared_ratio, Executor& executor) {
  assert(squared_ratio.rows() == window.rows && squared_ratio.columns() == window.columns);
  follow(window);
  const Rule rule{keep_, static_cast<float>(config_.limit)};
  const auto hear = [&](int first, int last) {
    for (int r = first; r < last; ++r)
      hear_row(squared_ratio.row(r).data(), factor_.row(r).data(), rule, sum_.row(r).data(), count_.row(r).data(),
               sums_.row(r).data(), counts_.row(r).data(), window_.columns);
  };
  executor.for_ranges(window_.rows, std::ref(hear));
  const auto smooth = [&](int first, int last) {
    for (int i = first; i < last; ++i) (i == 0 ? sums_ : counts_).smooth();
  };
  executor.for_ranges(2, std::ref(smooth));
  const auto weigh = [&](int first, int last) {
    for (int r = first; r < last; ++r)
      weigh_row(sums_.smoothed(r).data(), counts_.smoothed(r).data(), static_cast<float>(config_.prior_cells), scale_,
                share_, factor_.row(r).data(), window_.columns);
  };
  executor.for_ranges(window_.rows, std::ref(weigh));
}

}  // namespace scree::fractal
