#pragma once
// The model of the log energies of one window, in the eight lanes of its classes. For the fits only.

#include <algorithm>
#include <cmath>

#include "fractal/dimension_fit.hpp"
#include "fractal/lanes.hpp"

namespace scree::fractal {

inline constexpr Lanes kNoiseGains = {6, 6, 6, 6, 6, 4, 4, 4};  // IncrementClass::noise_gain in the order of kClasses
inline constexpr auto kLowestHurst = static_cast<float>(kMinHurst), kHighestHurst = static_cast<float>(kMaxHurst);

/// Position on a uniform axis: node below and the weight of the node above.
struct NodeBracket {
  int node;
  float weight;
};
SCREE_INLINE NodeBracket bracket(float position, int nodes) {
  const float clipped = std::clamp(position, 0.0F, static_cast<float>(nodes - 1));
  const int node = std::min(static_cast<int>(clipped), nodes - 2);
  return {node, clipped - static_cast<float>(node)};
}

SCREE_INLINE NodeBracket hurst_bracket(float hurst, int nodes) {
  return bracket((hurst - kLowestHurst) * (static_cast<float>(nodes - 1) / (kHighestHurst - kLowestHurst)), nodes);
}

SCREE_INLINE NodeBracket noise_bracket(float rho) {
  constexpr auto kMin = static_cast<float>(DimensionTables::kMinNoise);
  constexpr auto kScale = static_cast<float>(1.0 / DimensionTables::kLogNoiseStep);
  if (!(rho > kMin)) return {0, 0.0F};
  float log_rho;
  fast_log<float, std::int32_t>(rho / kMin, log_rho);
  return bracket(log_rho * kScale, DimensionTables::kNoiseNodes);
}

template <std::size_t N>
SCREE_INLINE int nearest_node(const std::array<double, N>& nodes, float value) {
  int best = 0;
  for (std::size_t i = 1; i < N; ++i)
    if (std::abs(static_cast<float>(nodes[i]) - value) <
        std::abs(static_cast<float>(nodes[static_cast<std::size_t>(best)]) - value))
      best = static_cast<int>(i);
  return best;
}

/// One window: what its tables are, and the model at the current (H, E).
struct EnergyModel {
  const DimensionTables* tables = nullptr;
  std::size_t first = 0;  ///< index of the gains of this nugget and fill
  float noise = 0.0F, nugget = 0.0F;
  float highest = 0.0F;                             ///< bound of H
  float least_energy = 0.0F;                        ///< bound of E
  float energy_of_c = 1.0F;                         ///< E/C
  Lanes log_energy = {}, unit = {}, residual = {};  ///< unit: energies per unit of C without the measurement noise

  SCREE_INLINE void open(const DimensionTables& all, const EnergyWindow& window) {
    tables = &all;
    const int nugget_node = all.has_nugget ? nearest_node(DimensionTables::kNuggets, window.nugget) : 0;
    first = DimensionTables::index(nugget_node, nearest_node(DimensionTables::kFills, window.fill), 0, 0);
    noise = window.noise;
    nugget = all.has_nugget ? window.nugget : 0.0F;
    highest = all.max_hurst[static_cast<std::size_t>(nugget_node)];
    least_energy = std::max(noise / kMaxRho, 1e-12F);
    load(window.log_energy, log_energy);
  }

  SCREE_INLINE void at_hurst(float hurst) {
    const NodeBracket at = hurst_bracket(hurst, DimensionTables::kVarianceNodes);
    const auto& below = tables->variances[static_cast<std::size_t>(at.node)];
    const auto& above = tables->variances[static_cast<std::size_t>(at.node) + 1];
    const float nu = nugget * (below.half_gamma0 + at.weight * (above.half_gamma0 - below.half_gamma0));
    Lanes low, high;
    load(below.reduced_signal, low);
    load(above.reduced_signal, high);
    unit = (1.0F - hurst) * (low + at.weight * (high - low)) + nu * kNoiseGains;
    energy_of_c = unit[0];
  }

  SCREE_INLINE void compare(float energy) {
    const Lanes model = (energy / energy_of_c) * unit + noise * kNoiseGains;
    Lanes log_model;
    fast_log<Lanes, IntLanes>(model, log_model);
    residual = log_energy - log_model;
  }

  /// Index of the table node nearest to (H, log ρ).
  SCREE_INLINE std::size_t node_index(const NodeBracket& hurst, const NodeBracket& rho) const {
    return first + static_cast<std::size_t>((hurst.node + (hurst.weight > 0.5F)) * DimensionTables::kNoiseNodes +
                                            rho.node + (rho.weight > 0.5F));
  }
};

}  // namespace scree::fractal
