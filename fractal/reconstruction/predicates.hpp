#pragma once
// The two questions a planar triangulation asks, answered exactly.

namespace scree::fractal {

struct PlanePoint {
  double x = 0.0, y = 0.0;
  friend bool operator==(const PlanePoint&, const PlanePoint&) = default;
};

/// +1: a, b, c turn counter-clockwise; −1: clockwise; 0: they lie on one line, exactly. Floating point with an error
/// bound first, exact expansions where that cannot tell. Source: [S97].
int orientation(const PlanePoint& a, const PlanePoint& b, const PlanePoint& c);

/// +1: d lies inside the circle through a, b, c (counter-clockwise), −1: outside, 0: on it, exactly. As above; on
/// lattices, where four points often share a circle, the exact part takes about a microsecond. Source: [S97].
int in_circle(const PlanePoint& a, const PlanePoint& b, const PlanePoint& c, const PlanePoint& d);

}  // namespace scree::fractal
