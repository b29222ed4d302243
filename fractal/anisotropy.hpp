#pragma once
// Is a surface rougher in one direction than in another?

#include <array>
#include <cstdint>

#include "core/executor.hpp"
#include "core/grid.hpp"
#include "core/result.hpp"
#include "fractal/directional_hurst.hpp"

namespace scree::fractal {

struct Anisotropy {
  /// T = uᵀ Σ⁻¹ u of the contrasts u = [ln q0°/q90°, ln q45°/q135°] of second-difference energies at steps of 1 and 2
  /// cells; chi-square with 4 degrees of freedom on an isotropic power law.
  double chi_square = 0.0;
  double p_value = 1.0;
  bool significant = false;  ///< p < .05
  /// Direction of the LARGEST roughness: along it heights change most over a given distance; correlation is longest
  /// across it. From +x (growing column) counter-clockwise towards +y (growing row), 0 ≤ direction < π.
  double direction_rad = 0.0;
  /// By how much the ground is stretched across direction_rad, if it is isotropic ground stretched; ≥ 1, and never
  /// exactly 1 by chance: look at p_value first. The contrasts bound it at kMaxStrength.
  double strength = 1.0;
  /// The index V of [X09], over the azimuths of `hurst`; NaN for windows below 16 cells. It answers another question:
  /// does H depend on direction? A stretch leaves it alone.
  double index_v = 0.0;
  double index_v_null95 = 0.0;  ///< exceeded by 5 % of isotropic surfaces of this size and H
  bool v_significant = false;
  std::array<double, kAzimuthCount> hurst{};  ///< H along 0°, 15°, … 165°
  double azimuth_lag_m = 0.0;                 ///< the longest lag of `hurst`
  double isotropic_hurst = 0.5;               ///< the fit that T takes its covariance from

  /// Significant, and stretched by kLeastStrength at least.
  bool matters() const;
};

inline constexpr double kMaxStrength = 100.0;
/// Thousands of cells make a stretch of a few percent significant; from here on it matters.
inline constexpr double kLeastStrength = 1.1;
inline bool Anisotropy::matters() const {
  return significant && strength >= kLeastStrength;
}

/// Complete second differences needed in each of the eight directed classes.
inline constexpr double kMinDirectedCount = 20.0;

/// Grids of one shape as for DimensionMapper::update: heights (NaN = unknown), known noise variance of each, returns
/// averaged in each (0 = the height of the exact centre). Adding a plane or scaling all heights and their noise changes
/// nothing; a quarter turn of the grid turns direction_rad. The covariance is theory's, for the holes that the grid has
/// (docs/fractal.md). Errors: usage (shapes differ, cell_m not positive); bad_data (fewer than kMinDirectedCount second
/// differences in a direction, heights on a plane).
/// Cost: see directional_hurst and pair_counts. Source: quadratic variations [IL97]; V: [X09].
Result<Anisotropy> analyse_anisotropy(const Grid<float>& height_m, double cell_m, const Grid<float>& variance_m2,
                                      const Grid<std::uint16_t>& hits, Executor& executor);

}  // namespace scree::fractal
