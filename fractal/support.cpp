#include "fractal/support.hpp"

#include <array>
#include <cmath>
#include <cstdlib>
#include <utility>

namespace scree::fractal {
namespace {

// Gauss–Legendre nodes and weights on [0, 1].
constexpr std::array<std::pair<double, double>, 8> kGauss8 = {{{0.019855071751231884, 0.050614268145188130},
                                                               {0.101666761293186630, 0.111190517226687235},
                                                               {0.237233795041835507, 0.156853322938943644},
                                                               {0.408282678752175098, 0.181341891689180991},
                                                               {0.591717321247824902, 0.181341891689180991},
                                                               {0.762766204958164493, 0.156853322938943644},
                                                               {0.898333238706813370, 0.111190517226687235},
                                                               {0.980144928248768116, 0.050614268145188130}}};
constexpr std::array<std::pair<double, double>, 3> kGauss3 = {{{0.112701665379258311, 0.277777777777777778},
                                                               {0.5, 0.444444444444444444},
                                                               {0.887298334620741689, 0.277777777777777778}}};

/// ∫∫ over the unit square of (a + b·s)(c + d·t)(s² + t²)^H: each triangle along rays t = s·x, where s integrates
/// in closed form and leaves a smooth integrand.
double corner_square(double hurst, double a, double b, double c, double d) {
  double sum = 0.0;
  for (const auto& node : kGauss8) {
    const double x = node.first;
    const auto triangle = [&](double p, double q, double r, double t) {
      return p * r / (2 * hurst + 2) + (q * r + p * t * x) / (2 * hurst + 3) + q * t * x / (2 * hurst + 4);
    };
    sum += node.second * std::pow(1.0 + x * x, hurst) * (triangle(a, b, c, d) + triangle(c, d, a, b));
  }
  return sum;
}

/// ∫∫ of the triangular density (1 − |s|)(1 − |t|) over one sign quadrant of (s, t) times |o + (s, t)|^(2H).
template <std::size_t N>
double smooth_quadrant(const std::array<std::pair<double, double>, N>& rule, double hurst, int dx, int dy, int sx,
                       int sy) {
  double sum = 0.0;
  for (const auto& [s, ws] : rule)
    for (const auto& [t, wt] : rule) {
      const double x = dx + sx * s, y = dy + sy * t;
      sum += ws * wt * (1.0 - s) * (1.0 - t) * std::pow(x * x + y * y, hurst);
    }
  return sum;
}

double quadrant(double hurst, int dx, int dy, int sx, int sy) {
  // The singular point −o lies on a corner of this quadrant's square when each component of −o is 0 or the sign.
  const auto corner = [](int o, int sign) { return o == 0 || o == -sign; };
  if (corner(dx, sx) && corner(dy, sy)) {
    const auto [a, b] = dx == 0 ? std::pair{1.0, -1.0} : std::pair{0.0, 1.0};
    const auto [c, d] = dy == 0 ? std::pair{1.0, -1.0} : std::pair{0.0, 1.0};
    return corner_square(hurst, a, b, c, d);
  }
  const bool far = dx * dx + dy * dy > 9;
  return far ? smooth_quadrant(kGauss3, hurst, dx, dy, sx, sy) : smooth_quadrant(kGauss8, hurst, dx, dy, sx, sy);
}

}  // namespace

double mean_variogram(Support support, double hurst, int dx, int dy) {
  dx = std::abs(dx);
  dy = std::abs(dy);
  if (support == Support::centre_point) {
    return dx == 0 && dy == 0 ? 0.0 : std::pow(static_cast<double>(dx) * dx + static_cast<double>(dy) * dy, hurst);
  }
  return quadrant(hurst, dx, dy, 1, 1) + quadrant(hurst, dx, dy, 1, -1) + quadrant(hurst, dx, dy, -1, 1) +
         quadrant(hurst, dx, dy, -1, -1);
}

}  // namespace scree::fractal
