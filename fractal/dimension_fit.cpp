#include "fractal/dimension_fit.hpp"

#include <algorithm>
#include <cmath>

#include "core/simd.hpp"
#include "fractal/lanes.hpp"

namespace scree::fractal {
namespace {

constexpr Lanes kNoiseGains = {6, 6, 6, 6, 6, 4, 4, 4};  // IncrementClass::noise_gain in the order of kClasses
constexpr auto kLow = static_cast<float>(kMinHurst), kHigh = static_cast<float>(kMaxHurst);

/// Position on a uniform axis: node below and the weight of the node above.
struct Bracket {
  int node;
  float weight;
};
SCREE_INLINE Bracket bracket(float position, int nodes) {
  const float clipped = std::clamp(position, 0.0F, static_cast<float>(nodes - 1));
  const int node = std::min(static_cast<int>(clipped), nodes - 2);
  return {node, clipped - static_cast<float>(node)};
}

SCREE_INLINE Bracket hurst_bracket(float hurst, int nodes) {
  return bracket((hurst - kLow) * (static_cast<float>(nodes - 1) / (kHigh - kLow)), nodes);
}

SCREE_INLINE Bracket noise_bracket(float rho) {
  constexpr auto kMin = static_cast<float>(DimensionTables::kMinNoise);
  constexpr auto kScale = static_cast<float>(1.0 / DimensionTables::kLogNoiseStep);
  if (!(rho > kMin)) return {0, 0.0F};
  float log_rho;
  fast_log<float, std::int32_t>(rho / kMin, log_rho);
  return bracket(log_rho * kScale, DimensionTables::kNoiseNodes);
}

template <std::size_t N>
SCREE_INLINE int nearest(const std::array<double, N>& nodes, float value) {
  int best = 0;
  for (std::size_t i = 1; i < N; ++i)
    if (std::abs(static_cast<float>(nodes[i]) - value) <
        std::abs(static_cast<float>(nodes[static_cast<std::size_t>(best)]) - value))
      best = static_cast<int>(i);
  return best;
}

/// One window being fitted: the tables of its nugget and fill, and the current model.
struct Fitter {
  const DimensionTables& tables;
  const DimensionTables::Gains* gains;  // [hurst][noise] of this nugget and fill
  float noise, nugget;
  float highest;                                    // bound of H
  float energy_of_c = 1.0F;                         // E/C
  Lanes log_energy = {}, unit = {}, residual = {};  // unit: energies per unit of E without the measurement noise

  SCREE_INLINE void model_at(float hurst) {
    const Bracket at = hurst_bracket(hurst, DimensionTables::kVarianceNodes);
    const auto& below = tables.variances[static_cast<std::size_t>(at.node)];
    const auto& above = tables.variances[static_cast<std::size_t>(at.node) + 1];
    const float nu = nugget * (below.half_gamma0 + at.weight * (above.half_gamma0 - below.half_gamma0));
    Lanes low, high;
    load(below.reduced_signal, low);
    load(above.reduced_signal, high);
    unit = (1.0F - hurst) * (low + at.weight * (high - low)) + nu * kNoiseGains;
    energy_of_c = unit[0];
    unit = (1.0F / energy_of_c) * unit;
  }

  SCREE_INLINE void compare(float energy) {
    const Lanes model = energy * unit + noise * kNoiseGains;
    Lanes log_model;
    fast_log<Lanes, IntLanes>(model, log_model);
    residual = log_energy - log_model;
  }

  using Row = std::array<float, kClassCount> DimensionTables::Gains::*;

  /// Gains of one parameter, bilinear between the four nodes around (H, log ρ), times the residual.
  SCREE_INLINE float change(Row row, const Bracket& h, const Bracket& t) const {
    const auto* node = gains + static_cast<std::ptrdiff_t>(h.node) * DimensionTables::kNoiseNodes + t.node;
    Lanes low, high, blend;
    load(node->*row, low);
    load((node + DimensionTables::kNoiseNodes)->*row, high);
    blend = low + h.weight * (high - low);
    if (t.weight > 0.0F) {
      load((node + 1)->*row, low);
      load((node + DimensionTables::kNoiseNodes + 1)->*row, high);
      blend += t.weight * (low + h.weight * (high - low) - blend);
    }
    return sum(blend * residual);
  }

  struct Step {
    float hurst, log_e;
  };
  SCREE_INLINE Step step(float hurst, float rho) const {
    const Bracket h = hurst_bracket(hurst, DimensionTables::kHurstNodes), t = noise_bracket(rho);
    const float by = change(&DimensionTables::Gains::hurst, h, t);
    if ((by > 0.0F && hurst >= highest) || (by < 0.0F && hurst <= kLow))
      return {0.0F, change(&DimensionTables::Gains::log_e_alone, h, t)};
    return {by, change(&DimensionTables::Gains::log_e, h, t)};
  }

  SCREE_INLINE float quadratic_form(const DimensionTables::Weight& weight) const {
    Lanes form = {};
    for (int c = 0; c < kClassCount; ++c) {  // by columns: the matrix is symmetric
      Lanes column;
      std::memcpy(&column, weight.data() + static_cast<std::ptrdiff_t>(c) * kClassCount, sizeof column);
      form += residual[c] * column;
    }
    return sum(form * residual);
  }
};

}  // namespace

SCREE_CLONES EnergyFit fit_energies(const DimensionTables& tables, const EnergyWindow& window) {
  // A step is accurate to about its square.
  constexpr float kTolerance = 1e-3F, kMaxHurstStep = 0.3F, kMaxLogStep = 1.5F;
  const int nugget_node = tables.has_nugget ? nearest(DimensionTables::kNuggets, window.nugget) : 0;
  const std::size_t first = DimensionTables::index(nugget_node, nearest(DimensionTables::kFills, window.fill), 0, 0);
  Fitter fitter{.tables = tables,
                .gains = tables.gains.data() + first,
                .noise = window.noise,
                .nugget = tables.has_nugget ? window.nugget : 0.0F,
                .highest = tables.max_hurst[static_cast<std::size_t>(nugget_node)]};
  load(window.log_energy, fitter.log_energy);
  const float least_energy = std::max(window.noise / kMaxRho, 1e-12F);
  EnergyFit fit;
  constexpr float kPerHurst =
      2.7725887F;  // second differences over 4 cells against 1 cell: a factor 4^(2H) without noise
  fit.hurst = std::clamp(window.log_energy[4] / kPerHurst, 0.1F, 0.7F);
  fitter.model_at(fit.hurst);
  float energy = std::max(1.0F - std::min(6.0F * window.noise, 0.9F), least_energy);
  for (int pass = 0; pass < kMaxPasses; ++pass) {
    fitter.compare(energy);
    const auto step = fitter.step(fit.hurst, window.noise / energy);
    const float hurst =
        std::clamp(fit.hurst + std::clamp(step.hurst, -kMaxHurstStep, kMaxHurstStep), kLow, fitter.highest);
    const float next_energy =
        std::max(energy * std::exp(std::clamp(step.log_e, -kMaxLogStep, kMaxLogStep)), least_energy);
    const float moved = std::abs(hurst - fit.hurst) + std::abs(next_energy / energy - 1.0F);
    fit.hurst = hurst;
    energy = next_energy;
    fitter.model_at(hurst);
    if (moved < kTolerance) break;
  }
  fitter.compare(energy);
  fit.c_value = energy / fitter.energy_of_c;
  fit.at_bound = fit.hurst >= fitter.highest;
  fit.tau = window.noise / fit.c_value;

  const Bracket h = hurst_bracket(fit.hurst, DimensionTables::kHurstNodes), t = noise_bracket(window.noise / energy);
  const auto sigma = [&](int hurst, int noise_node) {
    return fitter.gains[hurst * DimensionTables::kNoiseNodes + noise_node].sigma_hurst;
  };
  const float below = sigma(h.node, t.node) + t.weight * (sigma(h.node, t.node + 1) - sigma(h.node, t.node));
  const float above =
      sigma(h.node + 1, t.node) + t.weight * (sigma(h.node + 1, t.node + 1) - sigma(h.node + 1, t.node));
  fit.sigma_hurst = (below + h.weight * (above - below)) / std::sqrt(window.cells);
  const int node = (h.node + (h.weight > 0.5F)) * DimensionTables::kNoiseNodes + t.node + (t.weight > 0.5F);
  fit.chi_square = window.cells * fitter.quadratic_form(tables.weights[first + static_cast<std::size_t>(node)]);
  return fit;
}

}  // namespace scree::fractal
