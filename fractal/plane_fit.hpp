#pragma once
// The least-squares plane of a set of points.

#include <cmath>
#include <cstddef>

namespace scree::fractal {

struct Plane {
  double slope_x = 0.0, slope_y = 0.0;
};

/// Means, and sums of central products. All lengths in one unit.
struct PlaneMoments {
  double x = 0.0, y = 0.0, z = 0.0;
  double xx = 0.0, xy = 0.0, yy = 0.0, zx = 0.0, zy = 0.0, zz = 0.0;

  /// `at(i)` returns something with members x, y, z for 0 ≤ i < count.
  template <class At>
  PlaneMoments(std::size_t count, const At& at) {
    for (std::size_t i = 0; i < count; ++i) {
      const auto& p = at(i);
      x += p.x, y += p.y, z += p.z;
    }
    const auto n = static_cast<double>(count);
    x /= n, y /= n, z /= n;
    for (std::size_t i = 0; i < count; ++i) {
      const auto& p = at(i);
      const double dx = p.x - x, dy = p.y - y, dz = p.z - z;
      xx += dx * dx, xy += dx * dy, yy += dy * dy, zx += dz * dx, zy += dz * dy, zz += dz * dz;
    }
  }

  /// Squared ratio of the narrowest to the widest extent; 0 for points on a line, which have no plane.
  double flatness() const {
    const double half = 0.5 * (xx + yy), spread = std::hypot(0.5 * (xx - yy), xy);
    return (xx * yy - xy * xy) / ((half + spread) * (half + spread));
  }
  Plane plane() const {
    const double det = xx * yy - xy * xy;
    return {(zx * yy - zy * xy) / det, (zy * xx - zx * xy) / det};
  }
};

}  // namespace scree::fractal
