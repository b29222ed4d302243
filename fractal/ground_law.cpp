#include "fractal/ground_law.hpp"

#include <cmath>
#include <numbers>

namespace scree::fractal {
namespace {

constexpr double kPi = std::numbers::pi;

/// Spectral density of d^(2H) in the plane is this times ω^(−2H − 2).
double spectral_constant(double hurst) {
  return 2.0 * kPi * hurst * std::pow(4.0, hurst) * std::tgamma(1.0 + hurst) / std::tgamma(1.0 - hurst);
}

/// Matérn: constant·square·(ω² + κ²)^(−H − 1) has the variance constant·square/(4πH·κ^(2H)); half the plateau.
double matern_corner2(double hurst, double plateau_lag) {
  const double half_plateau = 0.5 * std::pow(plateau_lag, 2.0 * hurst);
  return std::pow(spectral_constant(hurst) / (4.0 * kPi * hurst * half_plateau), 1.0 / hurst);
}

}  // namespace

double blurred_power(double d, double hurst, double blur) {
  if (blur <= 0.0) return d > 0.0 ? std::pow(d, 2.0 * hurst) : 0.0;
  const double u = d * d / (4.0 * blur * blur);
  if (u > 60.0) {
    const double second = hurst * (1.0 - hurst) / u;
    return std::pow(d, 2.0 * hurst) * (1.0 + hurst * hurst / u + 0.5 * second * second);
  }
  double term = std::exp(-u), sum = term;
  for (int n = 1; n < 400; ++n) {
    term *= (hurst + n) * u / (static_cast<double>(n) * n);
    sum += term;
    if (n > u && term < 1e-12 * sum) break;
  }
  return std::pow(4.0 * blur * blur, hurst) * std::tgamma(1.0 + hurst) * sum;
}

double GroundLaw::variogram(double d) const {
  double value = first.square > 0.0 ? blurred_power(d, first.hurst, blur) : 0.0;
  if (plateau_lag > 0.0) {
    const double level = std::pow(plateau_lag, 2.0 * first.hurst);
    value = -level * std::expm1(-value / level);
  }
  value *= first.square;
  if (second.square > 0.0) value += second.square * blurred_power(d, second.hurst, blur);
  return value;
}

double GroundLaw::spectrum(double omega) const {
  const double omega2 = omega * omega;
  const double corner2 = plateau_lag > 0.0 ? matern_corner2(first.hurst, plateau_lag) : 0.0;
  double value = 0.0;
  if (first.square > 0.0)
    value += first.square * spectral_constant(first.hurst) * std::pow(omega2 + corner2, -first.hurst - 1.0);
  if (second.square > 0.0)
    value += second.square * spectral_constant(second.hurst) * std::pow(omega2, -second.hurst - 1.0);
  return value;
}

}  // namespace scree::fractal
