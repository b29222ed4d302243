#pragma once
// Laws of the ground that a structure function is compared with: variogram, spectrum, and what noise makes of them.

#include <vector>

namespace scree::fractal {

/// E|d + δ|^(2H) for a lag of length d whose two ends are each displaced by N(0, blur²) a coordinate; d^(2H) without
/// blur. With u = d²/(4 blur²): (4 blur²)^H·Γ(1 + H)·e^(−u)·Σ (1 + H)_n u^n/(n!)², and the asymptotic series beyond
/// u = 60; relative error below 1e-7. 0 < H < 1.
double blurred_power(double d, double hurst, double blur);

/// Sum of at most two power laws, or one that levels off; white noise on every point; places that are known to within
/// `blur` only. Unit of length: any, the same for all. The mean-square height change over a lag d of distinct points is
/// variogram(d) + 2·noise_variance.
struct GroundLaw {
  struct Power {
    double square = 0.0;  ///< mean-square change over the unit of length
    double hurst = 0.5;
  };
  Power first, second;
  /// > 0: first is square·r0^(2H)·(1 − exp(−(d/r0)^(2H))) with this r0, a plateau far beyond it
  double plateau_lag = 0.0;
  double noise_variance = 0.0;
  double blur = 0.0;  ///< standard deviation of each horizontal coordinate

  double variogram(double d) const;
  /// What displaced places look like: white noise of half of variogram(0), beside a smooth rest.
  double white_variance() const { return noise_variance + 0.5 * variogram(0.0); }
  /// Spectral density of the ground at angular frequency ω: variogram(d) = 2/(2π)²·∫ f·(1 − e^(−blur²ω²) cos ω·d) dω.
  /// The plateau's is that of a Matérn field with the same short lags and the same variance.
  double spectrum(double omega) const;
};

}  // namespace scree::fractal
