#pragma once
// How far apart the data are where they are farthest apart.

#include "core/grid.hpp"

namespace scree::fractal {

/// Side of the smallest blocks of 2^l cells, laid from the corner, all of which hold a cell that is not NaN; the longer
/// side of the grid (rounded up to 2^l) when only one block does. No hole is wider than twice that. O(cells).
int widest_gap_cells(const Grid<float>& height_m);

}  // namespace scree::fractal
