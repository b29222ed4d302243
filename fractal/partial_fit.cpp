// Fits of windows in which some classes have no increments: rare, at the borders of what is known.

#include <Eigen/Dense>

#include "fractal/dimension_fit.hpp"
#include "fractal/energy_model.hpp"

namespace scree::fractal {
namespace {

using ClassVector = Eigen::Matrix<double, kClassCount, 1>;
using ClassMatrix = Eigen::Matrix<double, kClassCount, kClassCount>;

ClassVector to_vector(const Lanes& v) {
  ClassVector out;
  for (int c = 0; c < kClassCount; ++c) out(c) = static_cast<double>(v[c]);
  return out;
}

/// What is left of the inverse covariance when the missing classes are integrated out, with zeros in their place:
/// W_rr − W_rm W_mm⁻¹ W_mr, one class at a time.
ClassMatrix without(ClassMatrix weight, std::uint8_t missing) {
  for (int c = 0; c < kClassCount; ++c)
    if (missing >> c & 1) {
      const ClassVector column = weight.col(c);
      weight -= column * column.transpose() / weight(c, c);
      weight.row(c).setZero();
      weight.col(c).setZero();
    }
  return weight;
}

struct PartialFitter : EnergyModel {
  /// For the window itself, not a window of one cell.
  ClassMatrix weight_at(const EnergyWindow& window, float hurst, float rho) const {
    const std::size_t node = node_index(hurst_bracket(hurst, DimensionTables::kHurstNodes), noise_bracket(rho));
    using Stored = Eigen::Map<const Eigen::Matrix<float, kClassCount, kClassCount>>;
    ClassMatrix weight = Stored(tables->weights[node].data()).cast<double>();
    ClassVector increments;
    for (int c = 0; c < kClassCount; ++c)
      increments(c) = static_cast<double>(window.cells) *
                      std::clamp(static_cast<double>(window.share[static_cast<std::size_t>(c)]), 1e-3, 1.0);
    const ClassVector scale = increments.cwiseSqrt();
    return scale.asDiagonal() * weight * scale.asDiagonal();
  }

  /// d(log model)/d(H, log E)
  Eigen::Matrix<double, kClassCount, 2> slopes(float hurst, float energy) {
    constexpr float kDelta = 2e-3F;
    const float above = std::min(hurst + kDelta, kHighestHurst), below = above - 2.0F * kDelta;
    Eigen::Matrix<double, kClassCount, 2> out;
    at_hurst(above);
    compare(energy);
    const ClassVector residual_above = to_vector(residual);
    at_hurst(below);
    compare(energy);
    out.col(0) = (to_vector(residual) - residual_above) / static_cast<double>(above - below);
    at_hurst(hurst);
    compare(energy);
    const Lanes signal = (energy / energy_of_c) * unit, share = signal / (signal + noise * kNoiseGains);
    out.col(1) = to_vector(share);
    return out;
  }
};

}  // namespace

bool can_do_without(std::uint8_t missing) {
  int present = 0;
  bool long_step = false;
  for (int c = 0; c < kClassCount; ++c)
    if ((missing >> c & 1) == 0) {
      ++present;
      long_step |= kClasses[static_cast<std::size_t>(c)].step > 1;
    }
  return present >= kClassCount / 2 && long_step;
}

EnergyFit fit_partial_energies(const DimensionTables& tables, const EnergyWindow& window) {
  constexpr double kTolerance = 1e-4, kMaxHurstStep = 0.3, kMaxLogStep = 1.5;
  PartialFitter fitter;
  fitter.open(tables, window);
  float hurst = 0.5F, energy = std::max(1.0F - std::min(6.0F * window.noise, 0.9F), fitter.least_energy);
  Eigen::Matrix2d information = Eigen::Matrix2d::Identity();
  ClassMatrix weight;
  ClassVector residual;
  for (int pass = 0; pass < kMaxPasses; ++pass) {
    const auto slopes = fitter.slopes(hurst, energy);
    const ClassMatrix all = fitter.weight_at(window, hurst, window.noise / energy);
    weight = without(all, window.missing);
    residual = to_vector(fitter.residual) + 0.5 * ClassMatrix(all.inverse()).diagonal();
    information = slopes.transpose() * weight * slopes;
    const Eigen::Vector2d gradient = slopes.transpose() * weight * residual;
    Eigen::Vector2d step = information.inverse() * gradient;
    if ((step(0) > 0.0 && hurst >= fitter.highest) || (step(0) < 0.0 && hurst <= kLowestHurst))
      step = {0.0, gradient(1) / information(1, 1)};
    step(0) = std::clamp(step(0), -kMaxHurstStep, kMaxHurstStep);
    step(1) = std::clamp(step(1), -kMaxLogStep, kMaxLogStep);
    hurst = std::clamp(hurst + static_cast<float>(step(0)), kLowestHurst, fitter.highest);
    energy = std::max(energy * std::exp(static_cast<float>(step(1))), fitter.least_energy);
    if (step.cwiseAbs().sum() < kTolerance) break;
  }
  fitter.at_hurst(hurst);
  EnergyFit fit;
  fit.hurst = hurst;
  fit.c_value = energy / fitter.energy_of_c;
  fit.at_bound = hurst >= fitter.highest;
  fit.tau = window.noise / fit.c_value;
  fit.sigma_hurst = static_cast<float>(std::sqrt(information.inverse()(0, 0)));
  fit.chi_square = static_cast<float>(residual.dot(weight * residual));
  return fit;
}

}  // namespace scree::fractal
