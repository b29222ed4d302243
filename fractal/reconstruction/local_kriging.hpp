#pragma once
// fBm at a point, given its heights at a few others.

#include <array>
#include <span>

#include "fractal/reconstruction/predicates.hpp"

namespace scree::fractal {

inline constexpr std::size_t kMaxLocalPoints = 12;

/// Height = Σ weight·known + √variance · normal; weights sum to 1.
struct LocalLaw {
  std::array<double, kMaxLocalPoints> weight{};
  double variance = 0.0;
};

/// The exact conditional law of fBm with E|z(p) − z(q)|² = unit²·r^(2H), coordinates in cells, given 1 to
/// kMaxLocalPoints points: intrinsic kriging by the Cholesky factor of the covariance of their heights above the first.
/// A point that says nothing the others do not (closer than rounding) gets the weight 0. Cost: m²/2 powers, m³/6
/// multiplications: .4 µs for six. Source: [CD12] ch. 3.
LocalLaw local_law(std::span<const PlanePoint> known, const PlanePoint& p, double hurst, double unit);

}  // namespace scree::fractal
