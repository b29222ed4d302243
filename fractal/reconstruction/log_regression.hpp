#pragma once
// Weighted linear regression on rows of floats, in few coefficients.

#include <array>
#include <vector>

#include "core/grid.hpp"

namespace scree::fractal {

/// y ≈ Σ a_j·x_j with x_0 = 1. The slopes (j ≥ 1) are held towards `expected` with the weight of `ridge` observations
/// of unit leverage, so that data which leave a slope open do not decide it by their noise. Sums of a row are formed in
/// float lanes, rows are added in double and in order: the result does not depend on who added which row.
class LogRegression {
 public:
  static constexpr int kMaxTerms = 9;
  static constexpr int kMost = 256;  ///< observations added at once
  using Coefficients = std::array<double, kMaxTerms>;

  /// Forgets all rows.
  void resize(int rows, int terms);
  /// Adds to a row's sums. `x`: terms − 1 arrays (the 1 is implied), `y`, and `weight` (0 or 1), of n ≤ kMost values.
  /// Safe for different rows at once.
  void add_row(int row, const std::array<const float*, kMaxTerms - 1>& x, const float* y, const float* weight, int n);
  /// Unused coefficients are 0. With no observation the intercept is 0.
  Coefficients fit(const Coefficients& expected, double ridge) const;

 private:
  static constexpr int kColumns = kMaxTerms + 1;  // terms and y
  int terms_ = 0;
  Grid<double> sums_;  // a row of the map: products of columns i ≤ j
};

}  // namespace scree::fractal
