#pragma once
// Direct solver for the coarsest level.

#include <vector>

#include "fractal/reconstruction/blend_prior.hpp"

namespace scree::fractal {

/// Cholesky factor of w1·L + w2·L² + diag(c) on a rows × columns grid (natural boundaries), banded along the shorter
/// side. Double precision. c ≥ 0 with at least one positive entry, else the matrix is singular. Cost: cells·(2·shorter
/// side)² to factor, cells·4·shorter side to solve.
class BandCholesky {
 public:
  void factor(int rows, int columns, BlendWeights weights, const std::vector<float>& data_precision);
  /// In place; `x` is row-major, `work` is scratch of the caller (solves may run side by side).
  void solve(std::vector<double>& x, std::vector<double>& work) const;

 private:
  std::size_t unknown(int row, int column) const;
  double& entry(std::size_t i, std::size_t j) { return band_[i * (width_ + 1) + (i - j)]; }
  void add_prior(BlendWeights weights);

  int rows_ = 0, columns_ = 0;
  std::size_t width_ = 0;     // half band
  std::vector<double> band_;  // row i: A(i, i), A(i, i−1), …
};

}  // namespace scree::fractal
