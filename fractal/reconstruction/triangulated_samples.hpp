#pragma once
// Scattered heights as the vertices of a Delaunay triangulation.

#include <vector>

#include "fractal/reconstruction/delaunay.hpp"
#include "fractal/reconstruction/surface_problem.hpp"
#include "fractal/reconstruction/triangle_raster.hpp"

namespace scree::fractal {

struct TriangulatedSamples {
  Delaunay mesh;            ///< coordinates in cells from the centre of cell (0, 0), as SurfacePoint
  std::vector<double> z_m;  ///< of each vertex; of repeated places the mean, weighted by 1/variance where all are > 0
  SurfacePoint at(int vertex) const {
    const PlanePoint& p = mesh.point(vertex);
    return {p.x, p.y, z_m[static_cast<std::size_t>(vertex)]};
  }
};

/// Every sample takes part, also those outside the grid: they hold the edges of the surface. Errors: usage (no cells,
/// draws < 0, a law outside 2 < D < 3, a map of laws of another shape); bad_data (spans of different length, values
/// that are not finite, negative variances, fewer than three places, all on one line).
Result<TriangulatedSamples> triangulate(const HeightSamples& samples, const SurfaceRequest& request);

/// The law where a point (in cells) lies; that of the nearest cell outside the grid.
FractalLaw law_at(const SurfaceRequest& request, double x, double y);

}  // namespace scree::fractal
