#pragma once
// The exact covariance of modulated ground: what an oracle knows.

#include <Eigen/Core>
#include <vector>

#include "tests/bench/reconstruction/modulated_truth.hpp"

namespace scree::bench {

/// Covariance of the heights that modulated_truth(law) makes, cells numbered row by row. With G the differences over
/// edges, W_i the edges' weights of node i and K_ij the covariance of the nodes (one white noise, planes included),
///
///     C = Σ_ij B_i·K_ij·B_j',   B_i = L⁺·G'·W_i·G,
///
/// applied to every unit vector: sparse solves for L⁺, Fourier transforms of twice the side for K_ij. K_ij has the
/// spectrum √(λ_i·λ_j) on the truth's torus; only its lags within the map matter, up to a constant that G takes away.
class ModulatedCovariance {
 public:
  /// Square, side even, the law the same in mirrored rows (asserted): half of the columns are made, cells² · 4 bytes.
  /// Cost: about 30 ms of one core for each of them at 96²; on all cores.
  explicit ModulatedCovariance(const fractal::LawMap& law);

  double operator()(int cell, int other) const {
    return other < columns_.cols() ? columns_(cell, other) : columns_(mirrored(cell), mirrored(other));
  }
  int cells() const { return static_cast<int>(columns_.rows()); }

 private:
  int mirrored(int cell) const { return (side_ - 1 - cell / side_) * side_ + cell % side_; }

  int side_;
  Eigen::MatrixXd columns_;  // of the cells in the first half of the rows
};

}  // namespace scree::bench
