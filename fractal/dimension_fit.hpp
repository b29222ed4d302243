#pragma once
// From the window's log energies to (H, log C): Gauss–Newton on the exact model with gains from the tables.

#include <array>

#include "fractal/dimension_tables.hpp"

namespace scree::fractal {

/// One window. Energies are relative to that of the first class, so that a fit does not depend on the unit of height.
struct EnergyWindow {
  std::array<float, kClassCount> log_energy;  ///< log of (mean energy_c / mean energy_0)
  float noise = 0.0F;                         ///< s² / mean energy_0
  float nugget = 0.0F;                        ///< κ: mean of 1/hits in the window
  float cells = 0.0F;                         ///< cells the window would need to hold as many known ones at this fill
  float fill = 1.0F;                          ///< probability that a neighbour of a known cell is known
};

struct EnergyFit {
  float hurst = 0.5F;
  bool at_bound = false;  ///< H stands at the largest value that these data can tell
  float c_value = 1.0F;   ///< C / mean energy_0, C at lag 1 cell
  float tau = 0.0F;       ///< s²/C
  float sigma_hurst = 0.0F;
  float chi_square = 0.0F;  ///< of the residual, 6 degrees of freedom; 7 when H is at its bound
};

inline constexpr int kMaxPasses = 40;
inline constexpr float kMaxRho = 30.0F;

/// At most kMaxPasses passes, each of 8 logarithms and a bilinear look-up. H stays within [kMinHurst, kMaxHurst], τ
/// below kMaxTau. Cost: see docs/fractal.md.
EnergyFit fit_energies(const DimensionTables& tables, const EnergyWindow& window);

}  // namespace scree::fractal
