#pragma once
// A float grid with two ghost columns on either side, for stencils of reach 2 with half-sample reflection at the
// borders (no flux: Neumann). Ghost rows are not stored: row indices reflect.

#include <vector>

namespace scree::fractal {

class PaddedField {
 public:
  static constexpr int kGhost = 2;

  /// rows, columns ≥ 2. All cells become 0.
  void resize(int rows, int columns) {
    rows_ = rows;
    columns_ = columns;
    cells_.assign(static_cast<std::size_t>(rows) * static_cast<std::size_t>(stride()), 0.0F);
  }
  /// Cells keep what they hold when the shape is this one already.
  void reshape(int rows, int columns) {
    if (rows != rows_ || columns != columns_) resize(rows, columns);
  }
  bool empty() const { return rows_ == 0; }
  int rows() const { return rows_; }
  int columns() const { return columns_; }

  float* row(int r) { return cells_.data() + offset(r); }
  const float* row(int r) const { return cells_.data() + offset(r); }
  /// Row r with −2 ≤ r < rows + 2.
  const float* reflected(int r) const { return row(r < 0 ? -1 - r : r >= rows_ ? 2 * rows_ - 1 - r : r); }

  void reflect_columns(int r) {
    float* x = row(r);
    x[-1] = x[0];
    x[-2] = x[1];
    x[columns_] = x[columns_ - 1];
    x[columns_ + 1] = x[columns_ - 2];
  }

 private:
  int stride() const { return columns_ + 2 * kGhost; }
  std::ptrdiff_t offset(int r) const { return static_cast<std::ptrdiff_t>(r) * stride() + kGhost; }
  int rows_ = 0, columns_ = 0;
  std::vector<float> cells_;
};

}  // namespace scree::fractal
