#pragma once
// A level's operator applied row after row, so that a pass over the grid does other work on the same rows.

#include <array>
#include <vector>

#include "fractal/reconstruction/multigrid.hpp"

namespace scree::fractal {

/// out = b − A·x for rows 0, 1, 2 … in turn. Varying weights take two steps, with s = w2·(L·x):
///   A·x = (c − ½ L·w1)·x + ½ w1·(L·x) + L·(½ w1·x + s),
/// because Σ_j ½(w_i + w_j)(x_i − x_j) = ½ [w·(L x) + L(w·x) − x·(L w)]_i; L x and the inner bracket live in rings of
/// three rows. One weight for all: the 13-point stencil.
class OperatorRows {
 public:
  /// Before row 0 of a pass. `x` must outlive the pass.
  void start(const BlendOperator::Level& level, const PaddedField& x);
  /// Rows of x up to row + 2 must hold their final values, ghost columns too.
  void residual(int row, const float* b, float* out);
  /// A row of zeros, for −A·x.
  const float* zeros() const { return zeros_.data(); }

 private:
  void fill(int row);
  float* inner(int row) { return inner_.data() + ring(row); }
  float* laplacian(int row) { return laplacian_.data() + ring(row); }
  std::size_t ring(int row) const { return static_cast<std::size_t>(row % 3) * stride_ + PaddedField::kGhost; }

  const BlendOperator::Level* level_ = nullptr;
  const PaddedField* x_ = nullptr;
  std::size_t stride_ = 0;
  std::vector<float> inner_, laplacian_, zeros_;
};

}  // namespace scree::fractal
