#pragma once
// fBm at a point, given its heights at the corners of a triangle: three ways.

#include <array>

#include "fractal/reconstruction/predicates.hpp"
#include "fractal/surface.hpp"

namespace scree::fractal {

/// Height = Σ weight·corner + √variance · normal.
struct TriangleLaw {
  std::array<double, 3> weight{};
  double variance = 0.0;
};

/// E|z(p) − z(corner)|² for the corners, and between the corners opposite 0, 1, 2.
struct TriangleVariogram {
  std::array<double, 3> to_corner{}, across{};
  /// V(r) = unit²·r^(2H), coordinates in cells, `unit` the rms change over one cell.
  TriangleVariogram(const std::array<PlanePoint, 3>& corners, const PlanePoint& p, double hurst, double unit);
};

/// Best linear prediction with weights that sum to 1, the exact conditional law: with corner 0 as origin the other two
/// have the covariance C = [V01, c; c, V02], c = (V01 + V02 − V12)/2, and p has q = (V0 + (V01, V02) − (V1, V2))/2
/// with them: weights C⁻¹q, variance V0 − q'C⁻¹q. Corners apart. Source: [CD12] ch. 3 (intrinsic kriging).
TriangleLaw conditional_law(const TriangleVariogram& v);

/// Equal weights with the exact variance of the difference: (V0 + V1 + V2)/3 − (V01 + V02 + V12)/9.
TriangleLaw exact_mean_law(const TriangleVariogram& v);

/// Equal weights with the variance of [DBF] eqs. V, VI: (A0² + A1² + A2²)/9, A_k² = max(0, V_k − spread), where
/// `spread` = var(mean of corners − corner) over a stage. With each A_k² exact instead of over a stage, and 3 in place
/// of 9, this would be exact_mean_law: the three displacements are one and the same variable, not independent ones.
TriangleLaw published_law(const TriangleVariogram& v, double spread);

}  // namespace scree::fractal
