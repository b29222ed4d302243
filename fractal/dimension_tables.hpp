#pragma once
// What theory says about the energies of the increment classes: their variances, and the best linear way back from
// log energies to (H, log C).

#include <array>
#include <vector>

#include "fractal/increments.hpp"
#include "fractal/support.hpp"

namespace scree::fractal {

inline constexpr double kMinHurst = 0.02, kMaxHurst = 0.98;

/// Model of the mean energies: E e_c² = C·[signal_c(H) + κ·b_c·γ̄0(H)/2] + s²·b_c, with C the squared height change at
/// lag 1 cell, b_c the noise gain, s² the noise variance of a cell value and κ the mean of 1/hits (0 for centre
/// The signal vanishes like 1 − H (a smooth surface has no second differences): signal/(1 − H) is what is tabulated.
/// What is fitted beside H is E, the noise-free energy of the first class, which the data fix far better than C: in
/// (H, log C) the steps cycle for H > 0.9.
struct DimensionTables {
  static constexpr int kVarianceNodes = 65;  ///< in H, uniform on [kMinHurst, kMaxHurst]
  static constexpr int kGainStride = 4;      ///< every fourth of them carries gains
  static constexpr int kHurstNodes = (kVarianceNodes - 1) / kGainStride + 1;
  /// In ρ = s²/E, the noise against second differences,
  /// uniform in log from kMinNoise, half a decade apart.
  static constexpr int kNoiseNodes = 12;
  static constexpr double kMinNoise = 1e-4;
  static constexpr double kLogNoiseStep = 1.1512925464970229;
  /// Nugget shares 1/k and fill fractions p for which gains exist; a window takes the nearest of each. They set the
  /// weighting and the interval only: the estimating equation itself uses the window's own κ.
  static constexpr std::array<double, 6> kNuggets = {1.0, 1.0 / 2, 1.0 / 3, 1.0 / 5, 1.0 / 10, 0.0};
  static constexpr std::array<double, 5> kFills = {1.0, 0.85, 0.7, 0.55, 0.4};

  struct VarianceNode {
    std::array<float, kClassCount> reduced_signal;  ///< signal_c/(1 − H)
    float half_gamma0;                              ///< γ̄0/2
  };
  /// Generalised least squares at one (κ, p, H, ρ), d = log energies − model: H += hurst·d, log E += log_e·d, or
  /// log E += log_e_alone·d when H stands at its bound. sigma_hurst is for a window of one cell: divide by √cells.
  struct Gains {
    std::array<float, kClassCount> hurst, log_e, log_e_alone;
    float sigma_hurst;
  };
  using Weight = std::array<float, static_cast<std::size_t>(kClassCount) *
                                       kClassCount>;  ///< inverse covariance of d, for a window of one cell

  /// Inverse covariance of ln(q0°/q90°) at steps 1 and 2 and of ln(q45°/q135°) likewise, as (11, 12, 22), for a window
  /// of one cell. Axes and diagonals are uncorrelated: a reflection turns one contrast round and not the other.
  struct ContrastWeight {
    std::array<float, 3> axes, diagonals;
  };

  std::vector<VarianceNode> variances;           ///< kVarianceNodes
  std::vector<Gains> gains;                      ///< [nugget][fill][hurst][noise]
  std::vector<Weight> weights;                   ///< likewise
  std::vector<ContrastWeight> contrast_weights;  ///< likewise
  /// [nugget] Largest H that the data can tell. One random point a cell makes a steep, smooth surface look like white
  /// noise again: the ratio of the energies at 4 and 1 cells rises with H up to here and falls beyond.
  std::vector<float> max_hurst;
  bool has_nugget = true;  ///< false for centre points: one nugget index, 0

  static double hurst_of(int variance_node) {
    return kMinHurst + (kMaxHurst - kMinHurst) * variance_node / (kVarianceNodes - 1);
  }
  static std::size_t index(int nugget, int fill, int hurst, int noise) {
    const auto n = [](int i) { return static_cast<std::size_t>(i); };
    return ((n(nugget) * kFills.size() + n(fill)) * n(kHurstNodes) + n(hurst)) * n(kNoiseNodes) + n(noise);
  }
};

/// The tables of a support; built on first use, kept for the process, safe to call from several threads.
/// Source: generalised covariance −γ̄/2 for increments [CD12] ch. 4; quadratic variations [IL97].
const DimensionTables& dimension_tables(Support support);

}  // namespace scree::fractal
