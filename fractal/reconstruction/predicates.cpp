#include "fractal/reconstruction/predicates.hpp"

#include <cmath>

#include "fractal/reconstruction/expansion.hpp"

namespace scree::fractal {
namespace {

// Relative error bounds of the determinants below in round-to-nearest double arithmetic [S97], ε = 2^−53.
constexpr double kEpsilon = 0x1p-53;
constexpr double kOrientationBound = (3.0 + 16.0 * kEpsilon) * kEpsilon;
constexpr double kInCircleBound = (10.0 + 96.0 * kEpsilon) * kEpsilon;

using Difference = Expansion<2>;

struct ExactVector {
  Difference x, y;
  ExactVector(const PlanePoint& to, const PlanePoint& from)
      : x(Difference::difference(to.x, from.x)), y(Difference::difference(to.y, from.y)) {}
};

Expansion<16> cross(const ExactVector& a, const ExactVector& b) {
  return sum(a.x * b.y, a.y * b.x, -1.0);
}
Expansion<16> square(const ExactVector& a) {
  return sum(a.x * a.x, a.y * a.y);
}

int exact_in_circle(const PlanePoint& a, const PlanePoint& b, const PlanePoint& c, const PlanePoint& d) {
  const ExactVector ad(a, d), bd(b, d), cd(c, d);
  return sum(sum(square(ad) * cross(bd, cd), square(bd) * cross(cd, ad)), square(cd) * cross(ad, bd)).sign();
}

int sign_of(double value) {
  return value > 0.0 ? 1 : value < 0.0 ? -1 : 0;
}

}  // namespace

int orientation(const PlanePoint& a, const PlanePoint& b, const PlanePoint& c) {
  const double left = (a.x - c.x) * (b.y - c.y), right = (a.y - c.y) * (b.x - c.x);
  const double determinant = left - right;
  if (std::abs(determinant) > kOrientationBound * (std::abs(left) + std::abs(right))) return sign_of(determinant);
  return cross(ExactVector(a, c), ExactVector(b, c)).sign();
}

int in_circle(const PlanePoint& a, const PlanePoint& b, const PlanePoint& c, const PlanePoint& d) {
  const double adx = a.x - d.x, ady = a.y - d.y, bdx = b.x - d.x, bdy = b.y - d.y, cdx = c.x - d.x, cdy = c.y - d.y;
  const double bc1 = bdx * cdy, bc2 = cdx * bdy, ca1 = cdx * ady, ca2 = adx * cdy, ab1 = adx * bdy, ab2 = bdx * ady;
  const double a2 = adx * adx + ady * ady, b2 = bdx * bdx + bdy * bdy, c2 = cdx * cdx + cdy * cdy;
  const double determinant = a2 * (bc1 - bc2) + b2 * (ca1 - ca2) + c2 * (ab1 - ab2);
  const double size = a2 * (std::abs(bc1) + std::abs(bc2)) + b2 * (std::abs(ca1) + std::abs(ca2)) +
                      c2 * (std::abs(ab1) + std::abs(ab2));
  if (std::abs(determinant) > kInCircleBound * size) return sign_of(determinant);
  return exact_in_circle(a, b, c, d);
}

}  // namespace scree::fractal
