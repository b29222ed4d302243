#pragma once
// Delaunay triangulation of points in the plane, one point at a time.

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "core/result.hpp"
#include "fractal/reconstruction/predicates.hpp"

namespace scree::fractal {

/// Incremental triangulation by Bowyer and Watson: a new point removes the triangles whose circles it is in and joins
/// the border of the hole. Decisions are exact, so points on lines, circles and lattices are as good as any others. The
/// outside is covered by ghost triangles on the edges of the hull with the vertex kInfinite, so points may be added
/// anywhere. Triangles are never deleted, only replaced: any index below triangle_count() names a live one.
/// Cost: O(1) expected an insertion from a triangle near the point. Sources: [B81], [W81]; ghosts: [S97].
class Delaunay {
 public:
  static constexpr int kInfinite = -1;

  struct Triangle {
    std::array<int, 3> vertex;     ///< counter-clockwise
    std::array<int, 3> neighbour;  ///< neighbour[k] across the edge opposite vertex[k]
  };
  struct Insertion {
    int vertex = 0;     ///< the new one, or the one that was there
    bool added = true;  ///< false: a vertex at exactly these coordinates existed
  };

  /// All points, inserted in rounds of doubling size along a Hilbert curve ([ACR03]); vertex i is point i. Points
  /// repeated exactly become one vertex, the first inserted: see vertex_of(). Errors, bad_data: spans of different
  /// length, coordinates that are not finite, fewer than three points, all points on one line. Cost: O(n log n), with
  /// expected O(n) triangles made (tests/bench/reconstruction, section delaunay).
  static Result<Delaunay> make(std::span<const double> x, std::span<const double> y);

  /// Adds a point, found by a walk from `near` (any triangle). Finite coordinates.
  Insertion insert(const PlanePoint& point, int near);
  /// The triangle that holds the point, its border included; a ghost when the point is outside the hull.
  int locate(const PlanePoint& point, int near) const;

  void reserve(std::size_t vertices);
  int vertex_count() const { return static_cast<int>(points_.size()); }
  int triangle_count() const { return static_cast<int>(triangles_.size()); }  ///< ghosts included
  bool is_ghost(int triangle) const;
  const Triangle& triangle(int index) const { return triangles_[static_cast<std::size_t>(index)]; }
  const PlanePoint& point(int vertex) const { return points_[static_cast<std::size_t>(vertex)]; }
  /// Of the vertices given to make(): the one that stands for it, itself unless it is a repetition.
  int vertex_of(int point) const { return representative_[static_cast<std::size_t>(point)]; }
  int repeated() const { return repeated_; }  ///< points given to make() that repeat another
  /// The triangles around the vertex added last, in order.
  std::span<const int> star() const { return {star_.data(), star_.size()}; }

 private:
  struct BorderEdge {  // of the hole, counter-clockwise
    int from, to, outer, outer_slot;
  };
  void start(int a, int b, int c);
  bool connect(int vertex, int near);
  bool in_conflict(const Triangle& triangle, const PlanePoint& point) const;
  int edge_from(int triangle, int vertex) const;
  void dig(int first, const PlanePoint& point);
  void fill(int vertex);
  int vertex_at(int triangle, const PlanePoint& point) const;

  std::vector<PlanePoint> points_;
  std::vector<Triangle> triangles_;
  std::vector<int> representative_;
  int repeated_ = 0;
  std::vector<int> removed_, star_;
  std::vector<BorderEdge> border_;
  std::vector<std::array<int, 2>> stack_;  // triangle of the hole, edge still to look across
};

}  // namespace scree::fractal
