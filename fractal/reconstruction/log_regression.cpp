#include "fractal/reconstruction/log_regression.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cassert>

#include "core/simd.hpp"
#include "fractal/lanes.hpp"

namespace scree::fractal {
namespace {

/// Four sums side by side: one would wait for itself.
SCREE_CLONES double dot(const float* a, const float* b, int n) {
  Lanes totals[4] = {};
  int i = 0;
  for (; i + 32 <= n; i += 32)
    for (int k = 0; k < 4; ++k) {
      Lanes x, y;
      std::memcpy(&x, a + i + 8 * k, sizeof x);
      std::memcpy(&y, b + i + 8 * k, sizeof y);
      totals[k] += x * y;
    }
  double rest = 0.0;
  for (; i < n; ++i) rest += static_cast<double>(a[i] * b[i]);
  const Lanes total = (totals[0] + totals[1]) + (totals[2] + totals[3]);
  return static_cast<double>(sum(total)) + rest;
}

SCREE_CLONES void multiply(const float* __restrict a, const float* __restrict b, float* __restrict out, int n) {
  for (int i = 0; i < n; ++i) out[i] = a[i] * b[i];
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
  assert(n <= kMost);
  alignas(64) std::array<float, kMost> ones, weighted;
  std::fill_n(ones.data(), n, 1.0F);
  std::array<const float*, kColumns> column = {ones.data()};
  for (int j = 1; j < terms_; ++j) column[static_cast<std::size_t>(j)] = x[static_cast<std::size_t>(j - 1)];
  column[static_cast<std::size_t>(terms_)] = y;
  for (int i = 0; i < terms_; ++i) {
    multiply(weight, column[static_cast<std::size_t>(i)], weighted.data(), n);
    for (int j = i; j <= terms_; ++j)
      sums_(row, i * kColumns + j) += dot(weighted.data(), column[static_cast<std::size_t>(j)], n);
  }
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
