#pragma once
// The energies of a whole grid as one window, and the law that fits them.

#include <cstdint>

#include "core/grid.hpp"
#include "fractal/dimension_fit.hpp"

namespace scree::fractal {

/// Sums over a whole grid in double. What the increments of a window are to DimensionMapper, without its borders.
struct GridEnergies {
  EnergyWindow window;
  double unit_m2 = 0.0;   ///< mean energy of the first class: what `window` is relative to
  double noise_m2 = 0.0;  ///< mean noise variance of a known cell, with the rounding of floats
  double known = 0.0;     ///< number of known cells
  Support support = Support::centre_point;
  bool enough = false;  ///< some increments of every class
  bool smooth = false;  ///< a class without energy: heights on a plane
};

/// Arguments as for DimensionMapper::update. Cost: 13 second differences a cell.
GridEnergies grid_energies(const MaskedHeights& heights, const Grid<float>& variance_m2,
                           const Grid<std::uint16_t>& hits);

}  // namespace scree::fractal
