#include "tests/bench/reconstruction/plain_solver.hpp"

#include "core/simd.hpp"
#include "fractal/lanes.hpp"

namespace scree::bench::plain {
using namespace fractal;
namespace {

SCREE_CLONES double dot_row(const float* a, const float* b, int n) {
  Lanes total = {};
  int i = 0;
  for (; i + 8 <= n; i += 8) {
    Lanes x, y;
    std::memcpy(&x, a + i, sizeof x);
    std::memcpy(&y, b + i, sizeof y);
    total += x * y;
  }
  float rest = 0.0F;
  for (; i < n; ++i) rest += a[i] * b[i];
  return static_cast<double>(sum(total)) + static_cast<double>(rest);
}

double dot(const PaddedField& a, const PaddedField& b) {
  double total = 0.0;
  for (int r = 0; r < a.rows(); ++r) total += dot_row(a.row(r), b.row(r), a.columns());
  return total;
}

SCREE_CLONES void advance_row(float alpha, const float* __restrict p, const float* __restrict q, float* __restrict x,
                              float* __restrict r, int n) {
  for (int i = 0; i < n; ++i) {
    x[i] += alpha * p[i];
    r[i] += alpha * q[i];  // q holds −A·p
  }
}

SCREE_CLONES void direction_row(float beta, const float* __restrict z, float* __restrict p, int n) {
  for (int i = 0; i < n; ++i) p[i] = z[i] + beta * p[i];
}

}  // namespace

SolveReport BlendSolver::solve(const BlendOperator& matrix, const PaddedField& b, double tolerance, int max_iterations,
                               PaddedField& x) {
  const BlendOperator::Level& fine = matrix.levels().front();
  const int rows = x.rows(), columns = x.columns();
  if (zero_.rows() != rows || zero_.columns() != columns)
    for (PaddedField* field : {&r_, &z_, &p_, &q_, &zero_}) field->resize(rows, columns);
  cycle_.resize(matrix);
  const double enough = tolerance * tolerance * rows * columns;

  for (int r = 0; r < rows; ++r) x.reflect_columns(r);
  BlendOperator::residual(fine, x, b, r_);
  cycle_.apply(matrix, r_, z_);
  double rz = dot(r_, z_);
  SolveReport report{1, rz < enough};
  p_ = z_;
  while (!report.converged && report.iterations < max_iterations) {
    BlendOperator::residual(fine, p_, zero_, q_);
    const double curvature = -dot(p_, q_);
    if (!(curvature > 0.0)) break;  // float rounding has eaten the direction
    const auto alpha = static_cast<float>(rz / curvature);
    for (int r = 0; r < rows; ++r) advance_row(alpha, p_.row(r), q_.row(r), x.row(r), r_.row(r), columns);
    cycle_.apply(matrix, r_, z_);
    const double next = dot(r_, z_);
    const auto beta = static_cast<float>(next / rz);
    for (int r = 0; r < rows; ++r) {
      direction_row(beta, z_.row(r), p_.row(r), columns);
      p_.reflect_columns(r);
    }
    rz = next;
    ++report.iterations;
    report.converged = rz < enough;
  }
  // The last cycle's correction costs nothing more and halves the error again.
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c) x.row(r)[c] += z_.row(r)[c];
  return report;
}

}  // namespace scree::bench::plain
