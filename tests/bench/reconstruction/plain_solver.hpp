#pragma once
// The solver for one law as it is written down, each step a loop over the grid of its own: what the fused passes of
// fractal/reconstruction/ are measured against.

#include <vector>

#include "fractal/reconstruction/blend_solver.hpp"

namespace scree::bench::plain {
using namespace fractal;

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

// Solves A·x = b by conjugate gradients with one V-cycle an iteration, until r·z < tolerance² · cells: r·z estimates
// the energy of the error, and that of a posterior sample is about the number of cells, so the criterion has no unit
// and does not ask for digits that the data do not hold. A relative residual would.
class BlendSolver {
 public:
  // `x` holds the first guess and receives the solution; its ghost columns need not be current. Deterministic.
  SolveReport solve(const BlendOperator& matrix, const PaddedField& b, double tolerance, int max_iterations,
                    PaddedField& x);

 private:
  VCycle cycle_;
  PaddedField r_, z_, p_, q_, zero_;
};

}  // namespace scree::bench::plain
