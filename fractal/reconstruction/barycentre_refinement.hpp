#pragma once
// The growing triangulation of barycentre.hpp, all realisations together.

#include <array>
#include <cstdint>
#include <vector>

#include "fractal/reconstruction/barycentre.hpp"
#include "fractal/reconstruction/triangle_kriging.hpp"
#include "fractal/reconstruction/triangulated_samples.hpp"

namespace scree::fractal {

/// `request` must outlive it.
class BarycentreRefinement {
 public:
  BarycentreRefinement(TriangulatedSamples&& samples, const SurfaceRequest& request, const BarycentreOptions& options,
                       int realisations);

  /// Insertions at barycentres until `count` more points are in; returns how many are.
  std::int64_t refine(std::int64_t count);
  /// The centres of all cells within the hull, in rounds that each are spread out over the grid.
  void insert_cell_centres();
  void rasterise(int k, Grid<float>& out) const;
  const Delaunay& mesh() const { return mesh_; }
  double height(int vertex, int k) const { return heights(vertex)[k]; }

 private:
  void reserve(std::int64_t more);
  std::vector<PlanePoint> random_places(std::int64_t first, std::int64_t count) const;
  bool insert_into(const PlanePoint& place);
  bool insert(const PlanePoint& point, int triangle, BarycentreLaw law);
  void raise_by_corners(int vertex, const std::array<int, 3>& corners, BarycentreLaw law);
  void raise_by_neighbours(int vertex);
  std::array<double, 2> normals(int vertex, int k) const;
  FractalLaw law_of(const PlanePoint& point) const;
  std::vector<double>::const_iterator heights(int vertex) const {
    return heights_.begin() + static_cast<std::ptrdiff_t>(vertex) * realisations_;
  }
  bool in_grid(const PlanePoint& point) const;
  void measure_spread();

  const SurfaceRequest& request_;
  BarycentreOptions options_;
  int realisations_;
  Delaunay mesh_;
  std::vector<double> heights_;  // of each vertex, one a realisation
  PlanePoint low_, high_;        // where places are drawn: what grid and hull's box share
  int near_ = 0;                 // a triangle at the point added last
  std::vector<double> spread_;   // published law: var(mean of corners − corner) of each realisation in this stage
  int stage_begin_ = 0;          // vertices
};

}  // namespace scree::fractal
