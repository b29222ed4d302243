#include "fractal/reconstruction/local_kriging.hpp"

#include <algorithm>
#include <cmath>

namespace scree::fractal {
namespace {

constexpr double kLeastPivot = 1e-10;  // of the point's own variance

double squared(const PlanePoint& a, const PlanePoint& b) {
  return (a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y);
}

}  // namespace

LocalLaw local_law(std::span<const PlanePoint> known, const PlanePoint& p, double hurst, double unit) {
  const std::size_t count = known.size() - 1;  // beside the first, the origin
  const auto variogram = [hurst](const PlanePoint& a, const PlanePoint& b) { return std::pow(squared(a, b), hurst); };
  std::array<double, kMaxLocalPoints> own{}, y{}, pivot{};
  std::array<std::array<double, kMaxLocalPoints>, kMaxLocalPoints> factor;  // C = L·diag(pivot)·L'
  const double to_origin = variogram(p, known[0]);
  double variance = to_origin;
  for (std::size_t i = 0; i < count; ++i) {
    own[i] = variogram(known[0], known[i + 1]);
    y[i] = 0.5 * (to_origin + own[i] - variogram(p, known[i + 1]));
    pivot[i] = own[i];
    for (std::size_t j = 0; j < i; ++j) {
      double c = 0.5 * (own[i] + own[j] - variogram(known[i + 1], known[j + 1]));
      for (std::size_t k = 0; k < j; ++k) c -= factor[i][k] * factor[j][k] * pivot[k];
      factor[i][j] = pivot[j] > 0.0 ? c / pivot[j] : 0.0;
      pivot[i] -= factor[i][j] * factor[i][j] * pivot[j];
      y[i] -= factor[i][j] * y[j];
    }
    if (pivot[i] <= kLeastPivot * own[i]) pivot[i] = y[i] = 0.0;
    if (pivot[i] > 0.0) variance -= y[i] * y[i] / pivot[i];
  }
  LocalLaw law;
  law.variance = unit * unit * std::max(0.0, variance);
  law.weight[0] = 1.0;
  for (std::size_t i = count; i-- > 0;) {
    double w = pivot[i] > 0.0 ? y[i] / pivot[i] : 0.0;
    for (std::size_t j = i + 1; j < count; ++j) w -= factor[j][i] * law.weight[j + 1];
    law.weight[i + 1] = pivot[i] > 0.0 ? w : 0.0;
    law.weight[0] -= law.weight[i + 1];
  }
  return law;
}

}  // namespace scree::fractal
