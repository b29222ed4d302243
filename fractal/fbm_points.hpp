#pragma once
// Exact fractional Brownian ground at arbitrary points.

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "core/result.hpp"
#include "fractal/surface.hpp"

namespace scree::fractal {

/// fBm at n given points by the Cholesky factor of its covariance ½(γ(p) + γ(q) − γ(p − q)), p and q relative to the
/// first point, where it is zero. Factored once, drawn from many times: O(n³/3) once, O(n²) a draw, n²·8 bytes.
class FbmPoints {
 public:
  /// Spans of one length, metres. Errors, usage: D outside 2.01 … 2.99, an amplitude that is not positive, fewer than 2
  /// or more than kMaxPoints points, points that are not finite or so close that the covariance is singular in double.
  static Result<FbmPoints> make(const FractalLaw& law, std::span<const double> x_m, std::span<const double> y_m);

  /// Heights in metres, zero at the first point. The same for the same seed.
  std::vector<double> draw(std::uint64_t seed) const;

  static constexpr std::size_t kMaxPoints = 6000;

 private:
  Eigen::MatrixXd factor_;
};

}  // namespace scree::fractal
