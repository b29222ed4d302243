#pragma once
// Direct solver for the coarsest level.

#include <vector>

#include "fractal/reconstruction/blend_field.hpp"

namespace scree::fractal {

/// Cholesky factor of a BlendField's operator with data, w1·L + w2·L² + diag(c) where the weights are equal, on a grid
/// with natural boundaries, banded along the shorter side. Double precision. c ≥ 0 with at least one positive entry,
/// else the matrix is singular. Cost: cells·(2·shorter side)² to factor, cells·4·shorter side to solve.
class BandCholesky {
 public:
  void factor(const BlendField& prior, const PaddedField& data_precision);
  /// In place; `x` is row-major, `work` is scratch of the caller (solves may run side by side).
  void solve(std::vector<double>& x, std::vector<double>& work) const;

 private:
  std::size_t unknown(int row, int column) const;
  double& entry(std::size_t i, std::size_t j) { return band_[i * (width_ + 1) + (i - j)]; }
  void add_prior(const BlendField& prior);
  void factor_band();

  int rows_ = 0, columns_ = 0;
  std::size_t width_ = 0;           // half band
  std::vector<double> band_;        // row i: L(i, i), L(i, i−1), …
  std::vector<double> columns_of_;  // row i: 1/L(i, i), L(i+1, i), …: forward substitution without sums
};

}  // namespace scree::fractal
