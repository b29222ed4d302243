#pragma once
// Where to start looking for a point in a growing triangulation.

#include <vector>

#include "fractal/reconstruction/delaunay.hpp"

namespace scree::fractal {

/// A lattice of triangles near their places over a rectangle, remade whenever the vertices have doubled, so that a walk
/// from at() takes O(1) steps expected where the vertices are spread evenly. A triangle may have been replaced since by
/// others nearby; any index names a live one (see Delaunay). Cost: O(1) amortised a vertex, 2 bytes a vertex.
class WalkHints {
 public:
  WalkHints(const Delaunay& mesh, const PlanePoint& low, const PlanePoint& high);
  int at(const PlanePoint& point) const { return triangle_[bucket(point)]; }
  /// After an insertion.
  void added(const PlanePoint& point);

 private:
  std::size_t bucket(const PlanePoint& point) const;
  void remake();

  const Delaunay& mesh_;
  PlanePoint low_, high_;
  int columns_ = 1, rows_ = 1;
  int made_at_ = 0;  // vertices
  std::vector<int> triangle_;
};

}  // namespace scree::fractal
