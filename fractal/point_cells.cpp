#include "fractal/point_cells.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace scree::fractal {

PointCells::PointCells(const PointColumns& points, const std::vector<int>& indices, double cell_m) : cell_(cell_m) {
  float x0 = std::numeric_limits<float>::infinity(), y0 = x0, x1 = -x0, y1 = -x0;
  for (const int i : indices) {
    const auto p = static_cast<std::size_t>(i);
    x0 = std::min(x0, points.x_m[p]), x1 = std::max(x1, points.x_m[p]);
    y0 = std::min(y0, points.y_m[p]), y1 = std::max(y1, points.y_m[p]);
  }
  columns_.resize(static_cast<int>(indices.size()));
  starts_.assign(2, 0);
  if (indices.empty()) return;
  x_min_ = x0, y_min_ = y0;
  const double width = double{x1} - x0, height = double{y1} - y0, most = 4.0 * static_cast<double>(indices.size());
  while ((std::floor(width / cell_) + 1.0) * (std::floor(height / cell_) + 1.0) > most + 4.0) cell_ *= 1.5;
  row_cells_ = static_cast<int>(width / cell_) + 1;
  rows_ = static_cast<int>(height / cell_) + 1;

  std::vector<int> cell_of(indices.size());
  starts_.assign(static_cast<std::size_t>(rows_) * static_cast<std::size_t>(row_cells_) + 1, 0);
  for (std::size_t k = 0; k < indices.size(); ++k) {
    const auto p = static_cast<std::size_t>(indices[k]);
    cell_of[k] = row_of(points.y_m[p]) * row_cells_ + column_of(points.x_m[p]);
    ++starts_[static_cast<std::size_t>(cell_of[k]) + 1];
  }
  for (std::size_t c = 1; c < starts_.size(); ++c) starts_[c] += starts_[c - 1];
  std::vector<int> next(starts_.begin(), starts_.end() - 1);
  for (std::size_t k = 0; k < indices.size(); ++k) {
    const auto p = static_cast<std::size_t>(indices[k]);
    const auto to = static_cast<std::size_t>(next[static_cast<std::size_t>(cell_of[k])]++);
    columns_.x[to] = points.x_m[p];
    columns_.y[to] = points.y_m[p];
    columns_.z[to] = points.z_m[p];
  }
}

int PointCells::column_of(double x) const {
  return static_cast<int>(std::clamp((x - x_min_) / cell_, 0.0, row_cells_ - 1.0));
}

int PointCells::row_of(double y) const {
  return static_cast<int>(std::clamp((y - y_min_) / cell_, 0.0, rows_ - 1.0));
}

void PointCells::runs_behind(int i, double reach_m, std::vector<IndexRun>& runs) const {
  runs.clear();
  const double reach = reach_m * (1.0 + 1e-5) + 1e-6 * cell_;  // more than float32 rounding of the distance
  const double x = columns_.x[static_cast<std::size_t>(i)], y = columns_.y[static_cast<std::size_t>(i)];
  const int row = row_of(y), last_row = row_of(y + reach);
  for (int r = row; r <= last_row; ++r) {
    const double rise = r == row ? 0.0 : std::max(0.0, y_min_ + r * cell_ - y);
    const double half = std::sqrt(std::max(0.0, reach * reach - rise * rise));
    const auto cells = static_cast<std::size_t>(r) * static_cast<std::size_t>(row_cells_);
    const int begin = starts_[cells + static_cast<std::size_t>(column_of(x - half))];
    const int end = starts_[cells + static_cast<std::size_t>(column_of(x + half)) + 1];
    runs.push_back({r == row ? i + 1 : begin, end});
  }
}

}  // namespace scree::fractal
