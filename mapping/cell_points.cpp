#include "mapping/cell_points.hpp"

#include <cmath>

#include "core/executor.hpp"

namespace scree::mapping {

namespace {

// Doubles until the comparison: a coordinate that is not finite, or far beyond int32, fails it.
std::int32_t window_cell(double x_m, double y_m, double cell_m, const LatticeWindow& window) {
  const double column = std::floor(x_m / cell_m) - window.min.x;
  const double row = std::floor(y_m / cell_m) - window.min.y;
  const bool inside = column >= 0 && column < window.columns && row >= 0 && row < window.rows;
  return inside ? static_cast<std::int32_t>(row) * window.columns + static_cast<std::int32_t>(column) : -1;
}

}  // namespace

void CellPoints::sort(const PointFrame& frame, const LatticeWindow& window, double cell_m, Executor& executor) {
  window_ = window;
  const std::size_t points = frame.size();
  cell_of_.resize(points);
  for_rows(executor, static_cast<int>(points), [&](int begin, int end) {
    for (int p = begin; p < end; ++p) {
      const auto i = static_cast<std::size_t>(p);
      const bool finite = std::isfinite(frame.z_m[i]) && std::isfinite(frame.range_variance_m2[i]);
      const double x_m = frame.anchor_map_m.x() + static_cast<double>(frame.x_m[i]);
      const double y_m = frame.anchor_map_m.y() + static_cast<double>(frame.y_m[i]);
      cell_of_[i] = finite ? window_cell(x_m, y_m, cell_m, window) : -1;
    }
  });

  const auto cells = static_cast<std::size_t>(window.rows) * static_cast<std::size_t>(window.columns);
  begin_.assign(cells + 1, 0);
  std::uint64_t inside = 0;
  for (std::size_t i = 0; i < points; ++i) {
    if (cell_of_[i] < 0) continue;
    ++begin_[static_cast<std::size_t>(cell_of_[i]) + 1];
    ++inside;
  }
  outside_ = points - inside;
  for (std::size_t c = 0; c < cells; ++c) begin_[c + 1] += begin_[c];

  next_.assign(begin_.begin(), begin_.end() - 1);
  z_m_.resize(inside);
  variance_m2_.resize(inside);
  horizontal_m2_.resize(inside);
  for (std::size_t i = 0; i < points; ++i) {
    if (cell_of_[i] < 0) continue;
    const std::uint32_t slot = next_[static_cast<std::size_t>(cell_of_[i])]++;
    z_m_[slot] = frame.z_m[i];
    const PlaceVariance place =
        place_variance(frame.range_m[i], frame.range_variance_m2[i], frame.angle_sigma_rad, frame.direction_z[i]);
    variance_m2_[slot] = place.height_m2;
    horizontal_m2_[slot] = place.horizontal_m2;
  }
}

}  // namespace scree::mapping
