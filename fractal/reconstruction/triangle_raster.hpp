#pragma once
// Heights of cell centres from triangles in space.

#include "core/grid.hpp"

namespace scree::fractal {

/// A point of a triangulated surface: x and y in cells from the centre of cell (0, 0), so that the centre of cell
/// (r, c) is (c, r); z in metres.
struct SurfacePoint {
  double x = 0.0, y = 0.0, z_m = 0.0;
};

/// Writes the plane through a, b, c into every cell of `out` whose centre lies in the triangle or within 1e-9 cells of
/// it (so that no centre on an edge is lost to rounding). Either orientation; nothing is written for a triangle without
/// area. Cost: O(rows + cells covered).
void rasterise_triangle(const SurfacePoint& a, const SurfacePoint& b, const SurfacePoint& c, Grid<float>& out);

}  // namespace scree::fractal
