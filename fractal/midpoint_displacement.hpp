#pragma once
// Midpoint displacement on squares and on triangles, to repeat what others did with them. Neither is fractional
// Brownian motion (increments are not stationary: creases along the coarse lattice) and neither is ever the truth of a
// test. Exact surfaces come from surface.hpp.

#include <cstdint>

#include "core/grid.hpp"
#include "core/result.hpp"
#include "fractal/surface.hpp"

namespace scree::fractal {

/// Diamond–square: centres of squares get the mean of four corners, then edges that of four neighbours (three at the
/// border), each displaced once by noise ∝ spacing^H. Shape, scale, validity, errors and cost as of
/// successive_random_additions(). Source: [S88] Saupe, algorithm MidPointFM2D.
Result<Grid<float>> midpoint_displacement_squares(const FractalLaw& law, int rows, int columns, double cell_m,
                                                  std::uint64_t seed);

/// Triangle edges: squares cut by one diagonal, every edge's midpoint gets the mean of its two ends and noise ∝
/// length^H. All else as above. Source: [F82] Fournier, Fussell, Carpenter.
Result<Grid<float>> midpoint_displacement_triangles(const FractalLaw& law, int rows, int columns, double cell_m,
                                                    std::uint64_t seed);

}  // namespace scree::fractal
