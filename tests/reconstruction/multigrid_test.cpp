#include "fractal/reconstruction/multigrid.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

#include "core/random.hpp"
#include "fractal/reconstruction/blend_solver.hpp"

namespace scree::fractal {
namespace {

/// The graph Laplacian of a grid by its definition.
Eigen::MatrixXd laplacian(int rows, int columns) {
  const int n = rows * columns;
  Eigen::MatrixXd l = Eigen::MatrixXd::Zero(n, n);
  const auto link = [&](int a, int b) { l(a, a) += 1, l(b, b) += 1, l(a, b) -= 1, l(b, a) -= 1; };
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c) {
      if (c + 1 < columns) link(r * columns + c, r * columns + c + 1);
      if (r + 1 < rows) link(r * columns + c, (r + 1) * columns + c);
    }
  return l;
}

struct DenseProblem {
  int rows, columns;
  BlendWeights weights;
  PaddedField precision, b;
  Eigen::MatrixXd matrix;
  Eigen::VectorXd right;

  DenseProblem(int rows_, int columns_, double dimension, double density, double data_precision, bool dense = true)
      : rows(rows_), columns(columns_), weights(blend_weights(dimension, 0.5)) {
    precision.resize(rows, columns);
    b.resize(rows, columns);
    const Eigen::MatrixXd l = dense ? laplacian(rows, columns) : Eigen::MatrixXd();
    matrix = static_cast<double>(weights.w1) * l + static_cast<double>(weights.w2) * l * l;
    right = Eigen::VectorXd::Zero(rows * columns);
    for (int r = 0; r < rows; ++r)
      for (int c = 0; c < columns; ++c) {
        if (to_uniform(random_words(1, 2, c, r)[0]) >= density) continue;
        precision.row(r)[c] = static_cast<float>(data_precision);
        b.row(r)[c] = static_cast<float>(data_precision * random_normals(1, 3, c, r)[0]);
        if (dense) matrix(r * columns + c, r * columns + c) += data_precision;
        right(r * columns + c) = static_cast<double>(b.row(r)[c]);
      }
  }
};

PaddedField random_field(int rows, int columns, std::uint64_t stream) {
  PaddedField field;
  field.resize(rows, columns);
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c) field.row(r)[c] = static_cast<float>(random_normals(5, stream, c, r)[0]);
  return field;
}

double product(const PaddedField& a, const PaddedField& b) {
  double sum = 0.0;
  for (int r = 0; r < a.rows(); ++r)
    for (int c = 0; c < a.columns(); ++c) sum += static_cast<double>(a.row(r)[c]) * static_cast<double>(b.row(r)[c]);
  return sum;
}

TEST(BlendPrior, HasTheFractalsSpectrumAndSlopeAtItsWavenumber) {
  for (const double dimension : {2.1, 2.5, 2.9}) {
    const double k0 = 0.7, hurst = 3.0 - dimension;
    const BlendWeights w = blend_weights(dimension, k0);
    const auto blend = [&](double k) {
      return 1.0 / (static_cast<double>(w.w1) * k * k + static_cast<double>(w.w2) * std::pow(k, 4));
    };
    const double s0 =
        2.0 * std::numbers::pi * hurst * std::pow(4.0, hurst) * std::tgamma(1 + hurst) / std::tgamma(1 - hurst);
    EXPECT_NEAR(blend(k0) / (s0 * std::pow(k0, -2.0 - 2.0 * hurst)), 1.0, 1e-6);
    EXPECT_NEAR(std::log(blend(k0 * 1.001) / blend(k0 / 1.001)) / std::log(1.001 * 1.001), -2.0 - 2.0 * hurst, 1e-3);
  }
}

TEST(BandCholesky, AgreesWithADenseSolve) {
  for (const auto& [rows, columns] : {std::pair{5, 9}, {9, 5}, {2, 2}, {4, 4}}) {
    DenseProblem problem(rows, columns, 2.4, 0.5, 20.0);
    problem.precision.row(0)[0] += 1.0F;
    problem.matrix(0, 0) += 1.0;
    std::vector<float> c;
    for (int r = 0; r < rows; ++r) c.insert(c.end(), problem.precision.row(r), problem.precision.row(r) + columns);
    BandCholesky cholesky;
    cholesky.factor(rows, columns, problem.weights, c);
    std::vector<double> x(static_cast<std::size_t>(rows * columns)), work;
    for (std::size_t i = 0; i < x.size(); ++i) x[i] = std::sin(static_cast<double>(i));
    const Eigen::VectorXd expected = problem.matrix.ldlt().solve(Eigen::Map<Eigen::VectorXd>(x.data(), rows * columns));
    cholesky.solve(x, work);
    EXPECT_LT((Eigen::Map<Eigen::VectorXd>(x.data(), rows * columns) - expected).norm(), 1e-9 * expected.norm());
  }
}

TEST(Multigrid, ShapeHoldsTheWindowWithLittleMargin) {
  for (int rows = 1; rows <= 512; rows += 37)
    for (int columns = 1; columns <= 512; columns += 41) {
      const MultigridShape shape(rows, columns);
      EXPECT_TRUE(shape.rows >= rows && shape.columns >= columns);
      EXPECT_EQ(shape.rows % (1 << shape.levels), 0);
      EXPECT_TRUE((shape.rows >> shape.levels) >= 2 && (shape.columns >> shape.levels) >= 2);
    }
  EXPECT_EQ(MultigridShape(200, 200).rows, 208);
}

TEST(Multigrid, ResidualIsThatOfTheDenseOperator) {
  const DenseProblem problem(8, 12, 2.4, 0.3, 5.0);
  BlendOperator matrix;
  matrix.set_up(MultigridShape(8, 12), problem.weights, problem.precision);
  PaddedField x = random_field(8, 12, 1), out = x;
  for (int r = 0; r < 8; ++r) x.reflect_columns(r);
  BlendOperator::residual(matrix.levels().front(), x, problem.b, out);
  Eigen::VectorXd flat(96);
  for (int i = 0; i < 96; ++i) flat(i) = static_cast<double>(x.row(i / 12)[i % 12]);
  const Eigen::VectorXd expected = problem.right - problem.matrix * flat;
  for (int i = 0; i < 96; ++i) EXPECT_NEAR(out.row(i / 12)[i % 12], expected(i), 2e-5 * expected.norm());
}

TEST(Multigrid, CycleIsSymmetricAndPositive) {
  const DenseProblem problem(48, 80, 2.3, 0.1, 1000.0, false);
  BlendOperator matrix;
  matrix.set_up(MultigridShape(48, 80), problem.weights, problem.precision);
  ASSERT_GE(matrix.levels().size(), 3U);
  VCycle cycle;
  cycle.resize(matrix);
  const PaddedField a = random_field(48, 80, 1), b = random_field(48, 80, 2);
  PaddedField za = a, zb = b;
  cycle.apply(matrix, a, za);
  cycle.apply(matrix, b, zb);
  EXPECT_GT(product(a, za), 0.0);
  EXPECT_NEAR(product(a, zb), product(b, za), 1e-5 * std::sqrt(product(a, za) * product(b, zb)));
}

// r·z < tolerance² · cells bounds the energy of the error up to the quality of the preconditioner (within 1.6 here);
// the least eigenvalue turns it into a bound of the error itself, but float rounding of b (1e4) sets the floor: 1e-4 of
// |x|.
TEST(Multigrid, SolverAgreesWithADenseSolve) {
  for (const double dimension : {2.2, 2.5, 2.8})
    for (const double data_precision : {1.0, 1e4}) {
      const DenseProblem problem(24, 28, dimension, 0.06, data_precision);
      BlendOperator matrix;
      matrix.set_up(MultigridShape(24, 28), problem.weights, problem.precision);
      ASSERT_GE(matrix.levels().size(), 2U);
      BlendSolver solver;
      PaddedField x;
      x.resize(24, 28);
      const SolveReport report = solver.solve(matrix, problem.b, 1e-4, 60, x);
      EXPECT_TRUE(report.converged);
      const Eigen::VectorXd expected = problem.matrix.llt().solve(problem.right);
      double worst = 0.0;
      for (int r = 0; r < 24; ++r)
        for (int c = 0; c < 28; ++c)
          worst = std::max(worst, std::abs(static_cast<double>(x.row(r)[c]) - expected(r * 28 + c)));
      EXPECT_LT(worst, 2e-3 * expected.cwiseAbs().maxCoeff()) << "D = " << dimension << " precision " << data_precision;
    }
}

}  // namespace
}  // namespace scree::fractal
