#include "fractal/dimension_fit.hpp"

#include "core/simd.hpp"
#include "fractal/energy_model.hpp"

namespace scree::fractal {
namespace {

// A step is accurate to about its square.
constexpr float kTolerance = 1e-3F, kMaxHurstStep = 0.3F, kMaxLogStep = 1.5F;
/// Second differences over 4 cells against 1 cell: a factor 4^(2H) without noise.
constexpr float kLogRatioPerHurst = 2.7725887F;

/// One window being fitted.
struct Fitter : EnergyModel {
  float hurst = 0.5F, energy = 1.0F, log_e = 0.0F;
  float log_noise = 0.0F;  ///< ln(noise/kMinNoise); without noise far below any energy's
  float least_log_e = 0.0F;
  bool done = false;

  SCREE_INLINE void start(const DimensionTables& all, const EnergyWindow& window) {
    open(all, window);
    hurst = std::clamp(window.log_energy[4] / kLogRatioPerHurst, 0.1F, 0.7F);
    energy = std::max(1.0F - std::min(6.0F * noise, 0.9F), least_energy);
    log_e = log_of(energy);
    least_log_e = log_of(least_energy);
    log_noise = noise > 1e-30F ? log_of(noise * static_cast<float>(1.0 / DimensionTables::kMinNoise)) : -100.0F;
    done = window.missing != 0;
    at_hurst(hurst);
  }

  static SCREE_INLINE float log_of(float x) {
    float out;
    fast_log<float, std::int32_t>(x, out);
    return out;
  }
  SCREE_INLINE NodeBracket noise_at() const {
    return bracket((log_noise - log_e) * static_cast<float>(1.0 / DimensionTables::kLogNoiseStep),
                   DimensionTables::kNoiseNodes);
  }

  using Row = std::array<float, kClassCount> DimensionTables::Gains::*;

  /// Gains of one parameter, bilinear between the four nodes around (H, log ρ), times the residual.
  SCREE_INLINE float change(Row row, const NodeBracket& h, const NodeBracket& t) const {
    const auto* node =
        tables->gains.data() + first + static_cast<std::ptrdiff_t>(h.node) * DimensionTables::kNoiseNodes + t.node;
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
  SCREE_INLINE Step step() const {
    const NodeBracket h = hurst_bracket(hurst, DimensionTables::kHurstNodes), t = noise_at();
    const float by = change(&DimensionTables::Gains::hurst, h, t);
    if ((by > 0.0F && hurst >= highest) || (by < 0.0F && hurst <= kLowestHurst))
      return {0.0F, change(&DimensionTables::Gains::log_e_alone, h, t)};
    return {by, change(&DimensionTables::Gains::log_e, h, t)};
  }

  SCREE_INLINE void pass() {
    if (done) return;
    compare(energy);
    const Step by = step();
    const float next_hurst =
        std::clamp(hurst + std::clamp(by.hurst, -kMaxHurstStep, kMaxHurstStep), kLowestHurst, highest);
    const float next_log_e = std::max(log_e + std::clamp(by.log_e, -kMaxLogStep, kMaxLogStep), least_log_e);
    done = std::abs(next_hurst - hurst) + std::abs(next_log_e - log_e) < kTolerance;
    hurst = next_hurst;
    log_e = next_log_e;
    energy = fast_exp(log_e);
    at_hurst(hurst);
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

  SCREE_INLINE void finish(const EnergyWindow& window, EnergyFit& fit) {
    compare(energy);
    fit.hurst = hurst;
    fit.c_value = energy / energy_of_c;
    fit.at_bound = hurst >= highest;
    fit.tau = noise / fit.c_value;
    const NodeBracket h = hurst_bracket(hurst, DimensionTables::kHurstNodes), t = noise_at();
    const auto* gains = tables->gains.data() + first;
    const auto sigma = [&](int hurst_node, int noise_node) {
      return gains[hurst_node * DimensionTables::kNoiseNodes + noise_node].sigma_hurst;
    };
    const float below = sigma(h.node, t.node) + t.weight * (sigma(h.node, t.node + 1) - sigma(h.node, t.node));
    const float above =
        sigma(h.node + 1, t.node) + t.weight * (sigma(h.node + 1, t.node + 1) - sigma(h.node + 1, t.node));
    fit.sigma_hurst = (below + h.weight * (above - below)) / std::sqrt(window.cells);
    const std::size_t node = node_index(h, t);
    fit.chi_square = window.cells * quadratic_form(tables->weights[node]);
    fit.contrast_chi_square = window.cells * contrast_form(tables->contrast_weights[node], window.log_contrast);
  }

  static SCREE_INLINE float contrast_form(const DimensionTables::ContrastWeight& w,
                                          const std::array<float, kContrastClassCount>& u) {
    const float axes = w.axes[0] * u[0] * u[0] + w.axes[2] * u[2] * u[2] + 2.0F * w.axes[1] * u[0] * u[2];
    return axes + w.diagonals[0] * u[1] * u[1] + w.diagonals[2] * u[3] * u[3] + 2.0F * w.diagonals[1] * u[1] * u[3];
  }
};

SCREE_CLONES void fit_pair(const DimensionTables& tables, const EnergyWindow* windows, EnergyFit* fits) {
  Fitter a, b;
  a.start(tables, windows[0]);
  b.start(tables, windows[1]);
  for (int pass = 0; pass < kMaxPasses && !(a.done && b.done); ++pass) {
    a.pass();
    b.pass();
  }
  a.finish(windows[0], fits[0]);
  b.finish(windows[1], fits[1]);
}

}  // namespace

void fit_energies(const DimensionTables& tables, std::span<const EnergyWindow> windows, std::span<EnergyFit> fits) {
  std::size_t i = 0;
  for (; i + 2 <= windows.size(); i += 2) fit_pair(tables, windows.data() + i, fits.data() + i);
  if (i < windows.size()) {
    const std::array<EnergyWindow, 2> twice = {windows[i], windows[i]};
    std::array<EnergyFit, 2> both;
    fit_pair(tables, twice.data(), both.data());
    fits[i] = both[0];
  }
  for (i = 0; i < windows.size(); ++i)
    if (windows[i].missing != 0) fits[i] = fit_partial_energies(tables, windows[i]);
}

}  // namespace scree::fractal
