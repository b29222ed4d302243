#pragma once
// From the window's log energies to (H, log C): Gauss–Newton on the exact model with gains from the tables.

#include <array>
#include <cstdint>
#include <span>

#include "fractal/dimension_tables.hpp"

namespace scree::fractal {

/// One window. Energies are relative to that of the first class, so that a fit does not depend on the unit of height.
struct EnergyWindow {
  std::array<float, kClassCount> log_energy{};  ///< log of (mean energy_c / mean energy_0); finite where missing too
  /// log of the ratio of mean energies of the two directions of a contrast class; 0 where there is none.
  std::array<float, kContrastClassCount> log_contrast{};
  float noise = 0.0F;   ///< s² / mean energy_0
  float nugget = 0.0F;  ///< κ: mean of 1/hits in the window
  float cells = 0.0F;   ///< cells the window would need to hold as many known ones at this fill
  float fill = 1.0F;    ///< probability that a neighbour of a known cell is known
  /// Increments of each class over what `cells` and `fill` promise; for windows with missing classes only.
  std::array<float, kClassCount> share{};
  std::uint8_t missing = 0;  ///< bit c: class c has no increments or no energy; never the first
};

struct EnergyFit {
  float hurst = 0.5F;
  bool at_bound = false;  ///< H stands at the largest value that these data can tell
  float c_value = 1.0F;   ///< C / mean energy_0, C at lag 1 cell
  float tau = 0.0F;       ///< s²/C
  float sigma_hurst = 0.0F;
  /// Of the residual; its degrees of freedom are the classes present less 2, and one more when H is at its bound.
  float chi_square = 0.0F;
  float contrast_chi_square = 0.0F;  ///< of log_contrast under isotropy, kContrastClassCount degrees of freedom
};

/// Are the other classes enough for two parameters? Half of them must be there, one with a step of 2 or 4 cells.
bool can_do_without(std::uint8_t missing);

inline constexpr int kMaxPasses = 40;
inline constexpr float kMaxRho = 30.0F;

/// One fit a window; `fits` is as long as `windows`. A fit depends on its window alone: two are worked on at a time, so
/// that one computes while the other waits. At most kMaxPasses passes, each of 8 logarithms and a bilinear look-up. H
/// stays within [kMinHurst, kMaxHurst], s²/E below kMaxRho. Cost: docs/fractal.md; windows with missing classes take
/// some microseconds each.
void fit_energies(const DimensionTables& tables, std::span<const EnergyWindow> windows, std::span<EnergyFit> fits);

/// The same for a window with missing classes: least squares on the others, weighted by the inverse of their part of
/// the covariance for as many increments as there are, and with the bias of the logarithm of a mean of few, −½ of its
/// variance, taken back. No contrast is tested.
EnergyFit fit_partial_energies(const DimensionTables& tables, const EnergyWindow& window);

}  // namespace scree::fractal
