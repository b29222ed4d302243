#include "fractal/reconstruction/triangle_kriging.hpp"

#include <algorithm>
#include <cmath>

namespace scree::fractal {
namespace {

constexpr double kThird = 1.0 / 3.0;

double squared(const PlanePoint& a, const PlanePoint& b) {
  return (a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y);
}

}  // namespace

TriangleVariogram::TriangleVariogram(const std::array<PlanePoint, 3>& corners, const PlanePoint& p, double hurst,
                                     double unit) {
  for (std::size_t k = 0; k < 3; ++k) {
    to_corner[k] = unit * unit * std::pow(squared(p, corners[k]), hurst);
    across[k] = unit * unit * std::pow(squared(corners[(k + 1) % 3], corners[(k + 2) % 3]), hurst);
  }
}

TriangleLaw conditional_law(const TriangleVariogram& v) {
  const double v01 = v.across[2], v02 = v.across[1], c = 0.5 * (v01 + v02 - v.across[0]);
  const double q1 = 0.5 * (v.to_corner[0] + v01 - v.to_corner[1]), q2 = 0.5 * (v.to_corner[0] + v02 - v.to_corner[2]);
  const double determinant = v01 * v02 - c * c;
  if (!(determinant > 1e-12 * v01 * v02)) return exact_mean_law(v);  // two corners are one but for rounding
  const double w1 = (v02 * q1 - c * q2) / determinant, w2 = (v01 * q2 - c * q1) / determinant;
  return {{1.0 - w1 - w2, w1, w2}, std::max(0.0, v.to_corner[0] - w1 * q1 - w2 * q2)};
}

TriangleLaw exact_mean_law(const TriangleVariogram& v) {
  const auto& [v0, v1, v2] = v.to_corner;
  const auto& [v12, v02, v01] = v.across;
  return {{kThird, kThird, kThird}, std::max(0.0, (v0 + v1 + v2) / 3.0 - (v01 + v02 + v12) / 9.0)};
}

TriangleLaw published_law(const TriangleVariogram& v, double spread) {
  double sum = 0.0;
  for (const double to : v.to_corner) sum += std::max(0.0, to - spread);
  return {{kThird, kThird, kThird}, sum / 9.0};
}

}  // namespace scree::fractal
