#pragma once
// Preconditioned conjugate gradients for the blend prior with data.

#include "fractal/reconstruction/v_cycle.hpp"

namespace scree::fractal {

struct SolveReport {
  int iterations = 0;  ///< multigrid cycles
  bool converged = false;
};

/// Solves A·x = b by conjugate gradients with one V-cycle an iteration, until r·z < tolerance² · cells: r·z estimates
/// the energy of the error, and that of a posterior sample is about the number of cells, so the criterion has no unit
/// and does not ask for digits that the data do not hold. A relative residual would. Three passes over the finest grid
/// an iteration.
class BlendSolver {
 public:
  /// `x` holds the first guess and receives the solution; its ghost columns need not be current. Deterministic.
  SolveReport solve(const BlendOperator& matrix, const PaddedField& b, double tolerance, int max_iterations,
                    PaddedField& x);

 private:
  void start(const BlendOperator::Level& fine, const PaddedField& b, PaddedField& x);
  /// p = z + β·p and q = −A·p; returns p'·A·p.
  double turn(const BlendOperator::Level& fine, float beta);

  VCycle cycle_;
  OperatorRows operator_;
  PaddedField r_, z_, p_, q_;
};

}  // namespace scree::fractal
