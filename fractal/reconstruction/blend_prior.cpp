#include "fractal/reconstruction/blend_prior.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace scree::fractal {

BlendWeights blend_weights(double dimension, double k0) {
  const double hurst = 3.0 - dimension;
  const double s0 =
      2.0 * std::numbers::pi * hurst * std::pow(4.0, hurst) * std::tgamma(1.0 + hurst) / std::tgamma(1.0 - hurst);
  return {static_cast<float>((dimension - 2.0) * std::pow(k0, 2.0 * hurst) / s0),
          static_cast<float>((3.0 - dimension) * std::pow(k0, 2.0 * hurst - 2.0) / s0)};
}

double blend_wavenumber(double dimension, double spacing_cells) {
  constexpr double kFirst = 2.2, kStep = 0.1, kSpacing = 4.47;  // found for 5 % of the cells measured
  constexpr std::array<double, 7> kBest = {0.3, 0.4, 0.5, 0.65, 0.8, 1.1, 1.8};
  const double position = std::clamp((dimension - kFirst) / kStep, 0.0, static_cast<double>(kBest.size() - 1));
  const auto node = std::min(static_cast<std::size_t>(position), kBest.size() - 2);
  const double weight = position - static_cast<double>(node);
  const double best = std::pow(kBest[node], 1.0 - weight) * std::pow(kBest[node + 1], weight);
  return std::clamp(best * kSpacing / spacing_cells, 0.25, 1.8);
}

}  // namespace scree::fractal
