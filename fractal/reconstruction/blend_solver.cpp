#include "fractal/reconstruction/blend_solver.hpp"

#include <algorithm>

#include "fractal/reconstruction/stencil_rows.hpp"

namespace scree::fractal {

/// r = b − A·x; nothing to subtract from x = 0.
void BlendSolver::start(const BlendOperator::Level& fine, const PaddedField& b, PaddedField& x) {
  const int rows = x.rows(), columns = x.columns();
  for (PaddedField* field : {&r_, &z_, &p_, &q_}) field->reshape(rows, columns);
  bool cold = true;
  for (int r = 0; r < rows && cold; ++r)
    cold = std::all_of(x.row(r), x.row(r) + columns, [](float v) { return v == 0.0F; });
  for (int r = 0; r < rows && !cold; ++r) x.reflect_columns(r);
  operator_.start(fine, x);
  for (int r = 0; r < rows; ++r)
    if (cold)
      std::copy_n(b.row(r), columns, r_.row(r));
    else
      operator_.residual(r, b.row(r), r_.row(r));
}

double BlendSolver::turn(const BlendOperator::Level& fine, float beta) {
  const int rows = p_.rows(), columns = p_.columns();
  double curvature = 0.0;
  operator_.start(fine, p_);
  for (int ahead = 0; ahead < rows + 2; ++ahead) {
    if (ahead < rows) {
      direction_row(beta, z_.row(ahead), p_.row(ahead), columns);
      p_.reflect_columns(ahead);
    }
    const int row = ahead - 2;
    if (row < 0) continue;
    operator_.residual(row, operator_.zeros(), q_.row(row));
    curvature -= dot_row(p_.row(row), q_.row(row), columns);
  }
  return curvature;
}

SolveReport BlendSolver::solve(const BlendOperator& matrix, const PaddedField& b, double tolerance, int max_iterations,
                               PaddedField& x) {
  const BlendOperator::Level& fine = matrix.levels().front();
  const int rows = x.rows(), columns = x.columns();
  const double enough = tolerance * tolerance * rows * columns;
  cycle_.resize(matrix);
  start(fine, b, x);
  double rz = cycle_.apply(matrix, r_, z_);
  SolveReport report{1, rz < enough};
  float beta = 0.0F;
  while (!report.converged && report.iterations < max_iterations) {
    if (report.iterations == 1)
      for (int r = 0; r < rows; ++r) std::fill_n(p_.row(r), columns, 0.0F);  // what an earlier solve left
    const double curvature = turn(fine, beta);
    if (!(curvature > 0.0)) break;  // float rounding has eaten the direction
    const Advance step{static_cast<float>(rz / curvature), &p_, &q_, &x};
    const double next = cycle_.apply(matrix, step, r_, z_);
    beta = static_cast<float>(next / rz);
    rz = next;
    ++report.iterations;
    report.converged = rz < enough;
  }
  // The last cycle's correction costs nothing more and halves the error again.
  for (int r = 0; r < rows; ++r) {
    float* out = x.row(r);
    const float* z = z_.row(r);
    for (int c = 0; c < columns; ++c) out[c] += z[c];
  }
  return report;
}

}  // namespace scree::fractal
