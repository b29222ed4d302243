#include "fractal/reconstruction/box_cascade.hpp"

#include <algorithm>
#include <cmath>

namespace scree::fractal {
namespace {

constexpr int kBoxes = 3;

/// `now` becomes what the boxes leave of `count` ones.
void smooth_ones(int count, int radius, std::vector<float>& now, std::vector<float>& next) {
  now.assign(static_cast<std::size_t>(count), 1.0F);
  next.resize(now.size());
  for (int pass = 0; pass < kBoxes; ++pass) {
    for (int i = 0; i < count; ++i) {
      next[static_cast<std::size_t>(i)] = 0.0F;
      for (int j = std::max(i - radius, 0); j <= std::min(i + radius, count - 1); ++j)
        next[static_cast<std::size_t>(i)] += now[static_cast<std::size_t>(j)];
    }
    std::copy(next.begin(), next.end(), now.begin());
  }
}

}  // namespace

int BoxCascade::radius_of(double sigma_cells) {
  // The variance of one box is ((2r + 1)² − 1)/12.
  return std::max(1, static_cast<int>(std::lround((std::sqrt(1.0 + 4.0 * sigma_cells * sigma_cells) - 1.0) / 2.0)));
}

void BoxCascade::resize(int rows, int columns, int radius) {
  if (rows == rows_ && columns == columns_ && radius == radius_) return;
  rows_ = rows;
  columns_ = columns;
  radius_ = radius;
  box_.resize(rows, columns, radius);
  smooth_ones(rows, radius, row_weight_, line_);
  smooth_ones(columns, radius, column_weight_, line_);
}

void BoxCascade::smooth() {
  for (int pass = 0; pass < kBoxes; ++pass) {
    box_.sum(scratch_);
    if (pass + 1 == kBoxes) break;
    for (int r = 0; r < rows_; ++r) {
      const auto from = box_.sums().row(r);
      std::copy(from.begin(), from.end(), box_.row(r).begin());
    }
  }
}

}  // namespace scree::fractal
