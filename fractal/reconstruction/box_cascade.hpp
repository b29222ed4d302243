#pragma once
// Smoothing whose cost hardly depends on its width.

#include <vector>

#include "fractal/box_sum.hpp"

namespace scree::fractal {

/// Three box sums in a row, within a few percent of a Gaussian. What lies outside the grid is 0, at every stage, and so
/// is what it adds to `weight`: values over weights are means of what lies inside. Fill `row(r)`, then `smooth()`.
/// Cost: about 6·log2(2·radius + 1) additions a cell. No allocation when the shape is unchanged and the
/// radius has been as large.
class BoxCascade {
 public:
  /// The radius whose three boxes have the standard deviation nearest to `sigma_cells` (at least 1).
  static int radius_of(double sigma_cells);

  void resize(int rows, int columns, int radius);
  std::span<float> row(int r) { return box_.row(r); }
  void smooth();
  std::span<const float> smoothed(int r) const { return box_.sums().row(r); }
  /// What a lone 1 leaves at its own place.
  float own_weight() const {
    const auto width = static_cast<float>(2 * radius_ + 1), line = (3.0F * width * width + 1.0F) / 4.0F;
    return line * line;
  }
  /// Of a field of ones the value at (r, c) is weight_of_row(r)·weight_of_column(c).
  float weight_of_row(int r) const { return row_weight_[static_cast<std::size_t>(r)]; }
  std::span<const float> weight_of_columns() const { return column_weight_; }

 private:
  int rows_ = 0, columns_ = 0, radius_ = 0;
  BoxSum box_;
  BoxScratch scratch_;
  std::vector<float> row_weight_, column_weight_, line_;
};

}  // namespace scree::fractal
