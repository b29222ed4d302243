#pragma once
// A = w1·L + w2·L² + diag(c) and a V(1,1) cycle for it that knows where the data are.

#include <vector>

#include "fractal/reconstruction/band_cholesky.hpp"
#include "fractal/reconstruction/blend_prior.hpp"
#include "fractal/reconstruction/padded_field.hpp"

namespace scree::fractal {

/// Size of the finest grid for a window: both sides become multiples of 2^levels, at most 2^levels − 1 cells larger.
/// The margin holds no data, so it only moves the boundary outwards.
struct MultigridShape {
  int rows = 0, columns = 0, levels = 0;
  explicit MultigridShape(int window_rows, int window_columns);
};

/// The operator on every level. Cell-centred coarsening by 2; restriction P' and prolongation P (bilinear, 3/4–1/4) are
/// damped by S = d0/(d0 + c) cell by cell: where a datum pins the surface, coarse corrections must not move it. Coarse
/// levels keep the stencil with w1 and w2/4, and c_H = 0.7·P'(S·c). Smoother: Jacobi with the 4th-kind Chebyshev step
/// 4/(3·λmax). Source: [B86] for the transfers; constants of S and c_H found by experiment (docs/fractal.md).
class BlendOperator {
 public:
  struct Level {
    BlendWeights weights;
    PaddedField precision;  ///< c
    PaddedField step;       ///< smoother, cell by cell
    PaddedField transfer;   ///< S
  };

  /// `precision`: c on the finest grid of `shape`, at least one cell positive. No allocation when the shape is
  /// unchanged.
  void set_up(const MultigridShape& shape, BlendWeights weights, const PaddedField& precision);

  /// out = b − A·x; the ghost columns of x must be current.
  static void residual(const Level& level, const PaddedField& x, const PaddedField& b, PaddedField& out);

  const std::vector<Level>& levels() const { return levels_; }
  const BandCholesky& coarsest() const { return coarsest_; }

 private:
  std::vector<Level> levels_;
  BandCholesky coarsest_;
  std::vector<float> coarse_precision_;
};

/// Buffers of one solve; solves with one operator may run side by side.
class VCycle {
 public:
  void resize(const BlendOperator& matrix);
  /// z ≈ A⁻¹·r, symmetric positive definite; the ghost columns of z are current afterwards.
  void apply(const BlendOperator& matrix, const PaddedField& r, PaddedField& z);

 private:
  struct Buffers {
    PaddedField x, b, t;
  };
  void descend(const BlendOperator& matrix, std::size_t level, const PaddedField& b, PaddedField& x);
  void solve_coarsest(const BlendOperator& matrix, const PaddedField& b, PaddedField& x);

  std::vector<Buffers> buffers_;
  std::vector<float> line_;
  std::vector<double> direct_, direct_work_;
};

}  // namespace scree::fractal
