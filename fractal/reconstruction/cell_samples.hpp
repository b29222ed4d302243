#pragma once
// Scattered heights as heights of cells' centres, with what lies between point and centre in their variance.

#include <cstddef>
#include <cstdint>

#include "core/grid.hpp"
#include "fractal/reconstruction/surface_problem.hpp"

namespace scree::fractal {

struct CellSamples {
  Grid<float> height_m;     ///< NaN = none
  Grid<float> variance_m2;  ///< > 0 where measured, else NaN
  Grid<std::uint16_t> hits;
  std::size_t inside = 0, outside = 0;  ///< samples
  std::size_t cells = 0;                ///< measured
};

/// The samples of a cell become their inverse-variance mean, an estimate of the height at the cell's centre. Its
/// variance is that of the measurements plus that of the ground in between, exactly for fBm: with weights w that sum to
/// one and V the variogram, Σ w_i V(p_i − c) − ½ ΣΣ w_i w_j V(p_i − p_j). Of a cell with more than kExactHits samples
/// the first so many stand for the ground's part: more samples lower the noise further, not what lies between. Samples
/// outside the grid are counted. Positions and heights finite. Cost: O(samples · kExactHits).
/// Source: [CD12] ch. 3 (estimation variance).
CellSamples bin_samples(const HeightSamples& samples, const SurfaceGrid& grid, const LawMap& law);

/// Samples in one cell used pair by pair.
inline constexpr int kExactHits = 32;

}  // namespace scree::fractal
