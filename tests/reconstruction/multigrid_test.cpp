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

enum class Prior { uniform, varying, broken };
constexpr Prior kPriors[] = {Prior::uniform, Prior::varying, Prior::broken};

/// D from 2.15 to 2.6 and amplitude from 0.3 to 1.5 across the grid; every tenth edge nearly cut.
BlendField make_prior(Prior kind, int rows, int columns, double dimension) {
  BlendField prior;
  prior.uniform = blend_weights(dimension, 0.5);
  if (kind == Prior::uniform) return prior;
  for (PaddedField* field : {&prior.w1, &prior.w2}) field->resize(rows, columns);
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c) {
      const double across = 0.5 + 0.5 * std::sin(0.3 * c + 0.2 * r);
      const BlendWeights w = blend_weights(2.15 + 0.45 * across, 0.5);
      const auto sigma2 = static_cast<float>(std::pow(0.3 + 1.2 * across, 2));
      prior.w1.row(r)[c] = w.w1 / sigma2;
      prior.w2.row(r)[c] = w.w2 / sigma2;
    }
  if (kind == Prior::varying) return prior;
  for (PaddedField* field : {&prior.right, &prior.down}) field->resize(rows, columns);
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c) {
      prior.right.row(r)[c] = to_uniform(random_words(1, 7, c, r)[0]) < 0.1 ? 0.02F : 1.0F;
      prior.down.row(r)[c] = to_uniform(random_words(1, 7, c, r)[1]) < 0.1 ? 0.02F : 1.0F;
    }
  return prior;
}

/// The prior's operator by its energy: a difference for each edge, L_e for each cell.
Eigen::MatrixXd dense_prior(const BlendField& prior, int rows, int columns) {
  const int n = rows * columns;
  Eigen::MatrixXd l = Eigen::MatrixXd::Zero(n, n), a = l;
  Eigen::VectorXd w1(n), w2(n);
  for (int i = 0; i < n; ++i) {
    w1(i) = static_cast<double>(prior.varies() ? prior.w1.row(i / columns)[i % columns] : prior.uniform.w1);
    w2(i) = static_cast<double>(prior.varies() ? prior.w2.row(i / columns)[i % columns] : prior.uniform.w2);
  }
  const auto link = [&](int i, int j, double e) {
    const auto add = [&](Eigen::MatrixXd& m, double v) { m(i, i) += v, m(j, j) += v, m(i, j) -= v, m(j, i) -= v; };
    add(l, e);
    add(a, e * 0.5 * (w1(i) + w1(j)));
  };
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c) {
      const int i = r * columns + c;
      if (c + 1 < columns) link(i, i + 1, prior.broken() ? static_cast<double>(prior.right.row(r)[c]) : 1.0);
      if (r + 1 < rows) link(i, i + columns, prior.broken() ? static_cast<double>(prior.down.row(r)[c]) : 1.0);
    }
  return a + l.transpose() * w2.asDiagonal() * l;
}

struct DenseProblem {
  int rows, columns;
  BlendField prior;
  PaddedField precision, b;
  Eigen::MatrixXd matrix;
  Eigen::VectorXd right;

  DenseProblem(int rows_, int columns_, double dimension, double density, double data_precision, bool dense = true,
               Prior kind = Prior::uniform)
      : rows(rows_), columns(columns_), prior(make_prior(kind, rows_, columns_, dimension)) {
    precision.resize(rows, columns);
    b.resize(rows, columns);
    if (dense) matrix = dense_prior(prior, rows, columns);
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
  for (const Prior kind : kPriors)
    for (const auto& [rows, columns] : {std::pair{5, 9}, {9, 5}, {2, 2}, {4, 4}}) {
      DenseProblem problem(rows, columns, 2.4, 0.5, 20.0, true, kind);
      problem.precision.row(0)[0] += 1.0F;
      problem.matrix(0, 0) += 1.0;
      BandCholesky cholesky;
      cholesky.factor(problem.prior, problem.precision);
      std::vector<double> x(static_cast<std::size_t>(rows * columns)), work;
      for (std::size_t i = 0; i < x.size(); ++i) x[i] = std::sin(static_cast<double>(i));
      const Eigen::VectorXd expected =
          problem.matrix.ldlt().solve(Eigen::Map<Eigen::VectorXd>(x.data(), rows * columns));
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

/// b − A·x on the finest level.
PaddedField residual(const BlendOperator& matrix, PaddedField x, const PaddedField& b) {
  PaddedField out = x;
  for (int r = 0; r < x.rows(); ++r) x.reflect_columns(r);
  OperatorRows rows;
  rows.start(matrix.levels().front(), x);
  for (int r = 0; r < x.rows(); ++r) rows.residual(r, b.row(r), out.row(r));
  return out;
}

TEST(Multigrid, ResidualIsThatOfTheDenseOperator) {
  for (const Prior kind : kPriors) {
    const DenseProblem problem(8, 12, 2.4, 0.3, 5.0, true, kind);
    BlendOperator matrix;
    matrix.set_up(MultigridShape(8, 12), problem.prior, problem.precision);
    const PaddedField x = random_field(8, 12, 1), out = residual(matrix, x, problem.b);
    Eigen::VectorXd flat(96);
    for (int i = 0; i < 96; ++i) flat(i) = static_cast<double>(x.row(i / 12)[i % 12]);
    const Eigen::VectorXd expected = problem.right - problem.matrix * flat;
    for (int i = 0; i < 96; ++i) EXPECT_NEAR(out.row(i / 12)[i % 12], expected(i), 2e-6 * expected.norm());
  }
}

// The two codes round differently: 13 products in one sum against two Laplacians, 2^-24 · 20 operations of values up to
// (4 w1 + 20 w2)·|x|.
TEST(Multigrid, EqualWeightsAreTheThirteenPointStencil) {
  const DenseProblem problem(32, 40, 2.4, 0.3, 5.0, false);
  BlendField field;
  for (PaddedField* w : {&field.w1, &field.w2}) w->resize(32, 40);
  for (int r = 0; r < 32; ++r) {
    std::fill_n(field.w1.row(r), 40, problem.prior.uniform.w1);
    std::fill_n(field.w2.row(r), 40, problem.prior.uniform.w2);
  }
  BlendOperator uniform, varying;
  uniform.set_up(MultigridShape(32, 40), problem.prior, problem.precision);
  varying.set_up(MultigridShape(32, 40), field, problem.precision);
  const PaddedField x = random_field(32, 40, 1);
  const PaddedField a = residual(uniform, x, problem.b), b = residual(varying, x, problem.b);
  const float scale = 4.0F * problem.prior.uniform.w1 + 20.0F * problem.prior.uniform.w2 + 5.0F;
  for (int r = 0; r < 32; ++r)
    for (int c = 0; c < 40; ++c) EXPECT_NEAR(a.row(r)[c], b.row(r)[c], 4.0F * 20.0F * scale * 0x1p-24F);
  VCycle cycle;
  PaddedField za = x, zb = x;
  cycle.resize(uniform);
  cycle.apply(uniform, x, za);
  cycle.apply(varying, x, zb);
  for (int r = 0; r < 32; ++r)
    for (int c = 0; c < 40; ++c) EXPECT_NEAR(za.row(r)[c], zb.row(r)[c], 1e-4F);
}

// Heights enter by differences: whatever the weights, a constant surface costs nothing but float rounding of terms of
// the size of the diagonal.
TEST(Multigrid, ConstantsAreFree) {
  for (const Prior kind : kPriors) {
    DenseProblem problem(24, 36, 2.4, 0.0, 0.0, false, kind);
    problem.precision.row(0)[0] = 1.0F;
    BlendOperator matrix;
    matrix.set_up(MultigridShape(24, 36), problem.prior, problem.precision);
    PaddedField x = problem.b, zero = problem.b;
    for (int r = 0; r < 24; ++r) std::fill_n(x.row(r), 36, 100.0F);
    const PaddedField out = residual(matrix, x, zero);
    EXPECT_NEAR(out.row(0)[0], -100.0F, 0.01F);
    for (int r = 1; r < 24; ++r)
      for (int c = 0; c < 36; ++c) {
        const float w1 = kind == Prior::uniform ? problem.prior.uniform.w1 : problem.prior.w1.row(r)[c];
        const float w2 = kind == Prior::uniform ? problem.prior.uniform.w2 : problem.prior.w2.row(r)[c];
        EXPECT_NEAR(out.row(r)[c], 0.0F, 100.0F * 0x1p-20F * (8.0F * w1 + 64.0F * w2));
      }
  }
}

TEST(Multigrid, CycleIsSymmetricAndPositive) {
  for (const Prior kind : kPriors) {
    const DenseProblem problem(48, 80, 2.3, 0.1, 1000.0, false, kind);
    BlendOperator matrix;
    matrix.set_up(MultigridShape(48, 80), problem.prior, problem.precision);
    ASSERT_GE(matrix.levels().size(), 3U);
    VCycle cycle;
    cycle.resize(matrix);
    const PaddedField a = random_field(48, 80, 1), b = random_field(48, 80, 2);
    PaddedField za = a, zb = b;
    const double reported = cycle.apply(matrix, a, za);
    cycle.apply(matrix, b, zb);
    EXPECT_GT(product(a, za), 0.0);
    EXPECT_NEAR(product(a, za), reported, 1e-5 * reported);
    EXPECT_NEAR(product(a, zb), product(b, za), 1e-5 * std::sqrt(product(a, za) * product(b, zb)));
  }
}

// r·z < tolerance² · cells bounds the energy of the error up to the quality of the preconditioner (within 1.6 here);
// the least eigenvalue turns it into a bound of the error itself, but float rounding of b (1e4) sets the floor: 1e-4 of
// |x|.
TEST(Multigrid, SolverAgreesWithADenseSolve) {
  for (const Prior kind : kPriors)
    for (const double dimension : {2.2, 2.5, 2.8})
      for (const double data_precision : {1.0, 1e4}) {
        if (kind != Prior::uniform && dimension > 2.2) continue;
        const DenseProblem problem(24, 28, dimension, 0.06, data_precision, true, kind);
        BlendOperator matrix;
        matrix.set_up(MultigridShape(24, 28), problem.prior, problem.precision);
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
        EXPECT_LT(worst, 2e-3 * expected.cwiseAbs().maxCoeff())
            << "D = " << dimension << " precision " << data_precision << " prior " << static_cast<int>(kind);
      }
}

}  // namespace
}  // namespace scree::fractal
