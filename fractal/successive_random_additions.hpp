#pragma once
// The generator of [AK96]'s experiments, to repeat them. It is not fractional Brownian motion and never the truth of a
// test: its ensemble has local slopes of .27 … .14 where H = .1 and .72 … .63 where H = .9 (docs/fractal.md). Exact
// surfaces come from surface.hpp.

#include <cstdint>

#include "core/grid.hpp"
#include "core/result.hpp"
#include "fractal/surface.hpp"

namespace scree::fractal {

/// Successive random additions: a square lattice refined by means of four neighbours (three at the border), noise of
/// standard deviation ∝ spacing^H added to every value, old and new, after each half step. The smallest 2^n + 1 lattice
/// that holds rows × columns is made and cut. Heights are scaled so that the rms change over 1 m along the axes of this
/// very surface is law.amplitude_m (between whole cells, and beyond half the surface, by a power law). Float32 metres,
/// reproducible from the seed alone. Validity: 2 < D < 3, at least 2 × 2 and at most 16385 cells a side. Errors: usage.
/// Cost: O(cells), about 2 normals a cell. Source: [S88] Saupe, ch. 2, algorithm MidPointFM2D with additions.
Result<Grid<float>> successive_random_additions(const FractalLaw& law, int rows, int columns, double cell_m,
                                                std::uint64_t seed);

}  // namespace scree::fractal
