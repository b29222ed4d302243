#pragma once
// The blend prior with data on every level of a multigrid.

#include <vector>

#include "fractal/reconstruction/band_cholesky.hpp"
#include "fractal/reconstruction/blend_field.hpp"
#include "fractal/reconstruction/padded_field.hpp"

namespace scree::fractal {

/// Size of the finest grid for a window: both sides become multiples of 2^levels, at most 2^levels − 1 cells larger.
/// The margin holds no data, so it only moves the boundary outwards.
struct MultigridShape {
  int rows = 0, columns = 0, levels = 0;
  explicit MultigridShape(int window_rows, int window_columns);
};

/// A = ∂²(energy of the BlendField) + diag(c) on every level: w1·L + w2·L² + diag(c) where the weights are the same
/// everywhere. Cell-centred coarsening by 2; restriction P' and prolongation P (bilinear, 3/4–1/4) are damped by
/// S = d0/(d0 + c) cell by cell, d0 the prior's diagonal: where a datum pins the surface, coarse corrections must not
/// move it. Coarse levels discretise the prior afresh (blend_field.hpp), c_H = 0.7·P'(S·c). Smoother: Jacobi with the
/// 4th-kind Chebyshev step, (4/3)·d0/(l1·(d0 + c)), l1 the absolute row sum of the prior. Source: [B86] for the
/// transfers; constants of S and c_H found by experiment (docs/reconstruction.md).
class BlendOperator {
 public:
  struct Level {
    BlendField prior;      ///< w1 and w2 filled wherever it varies or is broken
    PaddedField half_w1;   ///< where it varies
    PaddedField diagonal;  ///< c, or c − ½·L_e·w1 where the prior varies
    PaddedField transfer;  ///< S
    PaddedField step;      ///< smoother, where the prior varies; else step_factor·S
    float step_factor = 0.0F;

    bool varies() const { return prior.varies(); }
    /// The smoother's step of a row is smoother_factor() times smoother_row().
    float smoother_factor() const { return varies() ? 1.0F : step_factor; }
    const float* smoother_row(int r) const { return varies() ? step.row(r) : transfer.row(r); }
  };

  /// `precision`: c on the finest grid of `shape`, at least one cell positive; fields of `prior` of that shape too. No
  /// allocation when the shape is unchanged.
  void set_up(const MultigridShape& shape, const BlendField& prior, const PaddedField& precision);
  void set_up(const MultigridShape& shape, BlendWeights weights, const PaddedField& precision);

  const std::vector<Level>& levels() const { return levels_; }
  const BandCholesky& coarsest() const { return coarsest_; }

 private:
  void set_up_levels(const MultigridShape& shape, const PaddedField& precision);
  void coarse_precision(const Level& fine, PaddedField& coarse);

  std::vector<Level> levels_;
  BandCholesky coarsest_;
  std::vector<float> line_, ring_;
};

}  // namespace scree::fractal
