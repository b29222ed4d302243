#include "mapping/polar_rays.hpp"

#include <algorithm>

#include "core/executor.hpp"

namespace scree::mapping {

namespace {

// The ground's own descent is measured between returns this far apart.
constexpr float kBaselineMin_m = 0.5F;
constexpr float kBaselineMax_m = 2.0F;
// Its level is the lowest return this far back: the foot of a wall, not its top; the rim of a plateau.
constexpr float kLevel_m = 1.0F;

}  // namespace

PolarRays::PolarRays(const PolarConfig& config)
    : config_(config),
      bins_per_unit_(static_cast<float>(config.bins) / 4.0F),
      returns_(static_cast<std::size_t>(config.bins) * static_cast<std::size_t>(config.rings)),
      sights_(returns_.size()),
      touched_(static_cast<std::size_t>(config.bins), 0) {}

void PolarRays::clear() {
  for (int bin = 0; bin < config_.bins; ++bin) {
    if (!touched(bin)) continue;
    std::fill_n(returns_.begin() + static_cast<std::ptrdiff_t>(index(bin, 0)), config_.rings, Returns{});
    touched_[static_cast<std::size_t>(bin)] = 0;
  }
}

void PolarRays::add(std::span<const float> x_m, std::span<const float> y_m, std::span<const float> z_m,
                    Executor& executor) {
  where_.resize(x_m.size());
  slope_.resize(x_m.size());
  const float nearest_m = 0.5F * config_.cell_m;
  for_rows(executor, static_cast<int>(x_m.size()), [&](int begin, int end) {
    for (int p = begin; p < end; ++p) {
      const auto i = static_cast<std::size_t>(p);
      const float distance_m = std::sqrt(x_m[i] * x_m[i] + y_m[i] * y_m[i]);
      const bool usable = std::isfinite(distance_m) && std::isfinite(z_m[i]) && distance_m > nearest_m;
      where_[i] = usable ? static_cast<std::int32_t>(index(bin_of(x_m[i], y_m[i]), ring_of(distance_m))) : -1;
      slope_[i] = z_m[i] / distance_m;
    }
  });
  for (std::size_t i = 0; i < where_.size(); ++i) {  // minima and maxima: the order does not matter
    if (where_[i] < 0) continue;
    Returns& cell = returns_[static_cast<std::size_t>(where_[i])];
    cell.min_slope = std::min(cell.min_slope, slope_[i]);
    cell.max_slope = std::max(cell.max_slope, slope_[i]);
    cell.low_m = std::min(cell.low_m, z_m[i]);
    touched_[static_cast<std::size_t>(where_[i] / config_.rings)] = 1;
  }
}

void PolarRays::look(Executor& executor) {
  for_rows(executor, config_.bins, [&](int begin, int end) {
    for (int bin = begin; bin < end; ++bin)
      if (touched(bin)) look_along(bin);
  });
}

// A ray has crossed a whole cell of ring k for sure when its return lies in ring k + 2 or beyond.
void PolarRays::look_along(int bin) {
  const Returns* hits = returns_.data() + index(bin, 0);
  RaySight* sights = sights_.data() + index(bin, 0);
  float lowest = std::numeric_limits<float>::infinity();
  for (int ring = config_.rings - 1; ring >= 0; --ring) {
    if (ring + 2 < config_.rings) lowest = std::min(lowest, hits[ring + 2].min_slope);
    sights[ring].ceiling_slope = lowest;
  }

  float highest = -std::numeric_limits<float>::infinity();
  float descent = 0.0F;
  float level_m = 0.0F;
  int ground = -1;  // the last ring with a return
  int before = -1;  // a ring with a return, a baseline nearer
  for (int ring = 0; ring < config_.rings; ++ring) {
    RaySight& sight = sights[ring];
    sight.lip_m = -std::numeric_limits<float>::infinity();
    sight.shadowed = false;
    if (ring < config_.rings - 1 && hits[ring].low_m < std::numeric_limits<float>::infinity()) {
      highest = std::max(highest, hits[ring].max_slope);
      ground = ring;
      level_m = hits[ring].low_m;
      const int level_rings = std::min(ring, static_cast<int>(kLevel_m / config_.cell_m));
      for (int back = 1; back <= level_rings; ++back) level_m = std::min(level_m, hits[ring - back].low_m);
      if (before < 0) before = ring;
      for (int next = before + 1; static_cast<float>(ring - next) * config_.cell_m >= kBaselineMin_m; ++next)
        if (hits[next].low_m < std::numeric_limits<float>::infinity()) before = next;
      const float baseline_m = static_cast<float>(ring - before) * config_.cell_m;
      const bool measured = baseline_m >= kBaselineMin_m && baseline_m <= kBaselineMax_m;
      descent = measured ? std::clamp((hits[ring].low_m - hits[before].low_m) / baseline_m, -config_.max_descent, 0.0F)
                         : 0.0F;
      continue;
    }
    if (ground < 0) continue;
    const float beyond_m = static_cast<float>(ring - ground) * config_.cell_m;
    const float distance_m = (static_cast<float>(ring) + 0.5F) * config_.cell_m;
    if (beyond_m <= config_.lip_reach_m) sight.lip_m = level_m + descent * beyond_m;
    sight.shadowed = highest * distance_m > level_m;
  }
}

}  // namespace scree::mapping
