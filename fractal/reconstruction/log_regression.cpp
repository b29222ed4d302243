#include "fractal/reconstruction/log_regression.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include "core/simd.hpp"
#include "fractal/lanes.hpp"

namespace scree::fractal {
namespace {

/// Σ w·a·b; null stands for ones.
SCREE_CLONES double weighted_dot(const float* w, const float* a, const float* b, int n) {
  Lanes total = {};
  int i = 0;
  for (; i + 8 <= n; i += 8) {
    Lanes x, y;
    std::memcpy(&x, w + i, sizeof x);
    if (a != nullptr) {
      std::memcpy(&y, a + i, sizeof y);
      x *= y;
    }
    if (b != nullptr) {
      std::memcpy(&y, b + i, sizeof y);
      x *= y;
    }
    total += x;
  }
  double rest = 0.0;
  for (; i < n; ++i) rest += static_cast<double>(w[i] * (a != nullptr ? a[i] : 1.0F) * (b != nullptr ? b[i] : 1.0F));
  return static_cast<double>(sum(total)) + rest;
}

using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, LogRegression::kMaxTerms,
                             LogRegression::kMaxTerms>;  // on the stack
using Column = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, LogRegression::kMaxTerms, 1>;

}  // namespace

void LogRegression::resize(int rows, int terms) {
  terms_ = terms;
  sums_.assign(rows, kColumns * kColumns, 0.0);
}

void LogRegression::add_row(int row, const std::array<const float*, kMaxTerms - 1>& x, const float* y,
                            const float* weight, int n) {
  std::array<const float*, kColumns> column = {nullptr};
  for (int j = 1; j < terms_; ++j) column[static_cast<std::size_t>(j)] = x[static_cast<std::size_t>(j - 1)];
  column[static_cast<std::size_t>(terms_)] = y;
  for (int i = 0; i < terms_; ++i)
    for (int j = i; j <= terms_; ++j)
      sums_(row, i * kColumns + j) +=
          weighted_dot(weight, column[static_cast<std::size_t>(i)], column[static_cast<std::size_t>(j)], n);
}

LogRegression::Coefficients LogRegression::fit(const Coefficients& expected, double ridge) const {
  Square normal = Square::Zero(terms_, terms_);
  Column right = Column::Zero(terms_);
  for (int r = 0; r < sums_.rows(); ++r)
    for (int i = 0; i < terms_; ++i) {
      for (int j = i; j < terms_; ++j) normal(i, j) += sums_(r, i * kColumns + j);
      right(i) += sums_(r, i * kColumns + terms_);
    }
  Coefficients result = {};
  if (!(normal(0, 0) > 0.0)) return result;
  for (int i = 0; i < terms_; ++i) {
    for (int j = 0; j < i; ++j) normal(i, j) = normal(j, i);
    if (i == 0) continue;
    normal(i, i) += ridge;
    right(i) += ridge * expected[static_cast<std::size_t>(i)];
  }
  const Column solution = normal.ldlt().solve(right);
  for (int i = 0; i < terms_; ++i) result[static_cast<std::size_t>(i)] = solution(i);
  return result;
}

}  // namespace scree::fractal
