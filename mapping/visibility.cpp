#include "mapping/visibility.hpp"

#include <algorithm>
#include <cmath>

#include "core/executor.hpp"

namespace scree::mapping {

namespace {

constexpr float kSeenThroughSigmas = 5.0F;
constexpr float kHalfDiagonal = 0.7072F;  // a ray may cross a cell from corner to corner

PolarConfig polar_config(const VisibilityConfig& config) {
  PolarConfig polar;
  polar.cell_m = static_cast<float>(config.cell_m);
  polar.bins = std::max(4 * config.size_cells, 64);  // a bin is about one cell wide at the window's edge
  polar.rings = config.size_cells + 2;
  polar.max_descent = config.max_descent;
  return polar;
}

// Rows [begin, end) whose sensor origins stay within a cell of the first.
std::size_t piece_end(const PointFrame& frame, std::size_t begin, float cell_m) {
  std::size_t end = begin + 1;
  while (end < frame.sensor_m.size() && (frame.sensor_m[end] - frame.sensor_m[begin]).norm() <= cell_m) ++end;
  return end;
}

void lower_ceiling(const RaySight& sight, float distance_m, float sensor_z_m, float cell_m, MapCell& cell) {
  const float half_m = kHalfDiagonal * cell_m;
  const float highest_at_m = sight.ceiling_slope < 0.0F ? distance_m - half_m : distance_m + half_m;
  const float ceiling_m = sensor_z_m + sight.ceiling_slope * highest_at_m;
  cell.lower_ceiling(ceiling_m, sensor_z_m + sight.lip_m);
}

}  // namespace

Visibility::Visibility(const VisibilityConfig& config) : config_(config), rays_(polar_config(config)) {}

void Visibility::look_from(const PointFrame& frame, std::size_t row_begin, std::size_t row_end, Executor& executor) {
  const std::size_t first = frame.row_begin[row_begin];
  const std::size_t count = frame.row_begin[row_end] - first;
  x_m_.resize(count);
  y_m_.resize(count);
  z_m_.resize(count);
  for (std::size_t row = row_begin; row < row_end; ++row) {
    const Eigen::Vector3f& sensor = frame.sensor_m[row];
    for (std::size_t i = frame.row_begin[row]; i < frame.row_begin[row + 1]; ++i) {
      x_m_[i - first] = frame.x_m[i] - sensor.x();
      y_m_[i - first] = frame.y_m[i] - sensor.y();
      z_m_[i - first] = frame.z_m[i] - sensor.z();
    }
  }
  rays_.clear();
  rays_.add(x_m_, y_m_, z_m_, executor);
  rays_.look(executor);
}

void Visibility::mark(const Eigen::Vector3d& origin_map_m, const CellPoints& points, const HeightPlane& off,
                      Executor& executor, RollingGrid<MapCell>& map) {
  const LatticeWindow& window = map.window();
  const double cell_m = config_.cell_m;
  const auto pitch_m = static_cast<float>(cell_m);
  // Centre of cell (0, 0) relative to the sensor.
  const auto x0_m = static_cast<float>((window.min.x + 0.5) * cell_m - origin_map_m.x());
  const auto y0_m = static_cast<float>((window.min.y + 0.5) * cell_m - origin_map_m.y());
  for_rows(executor, window.rows, [&](int begin, int end) {
    for (int row = begin; row < end; ++row) {
      const float y_m = y0_m + static_cast<float>(row) * pitch_m;
      for (int column = 0; column < window.columns; ++column) {
        const float x_m = x0_m + static_cast<float>(column) * pitch_m;
        const float distance_m = std::sqrt(x_m * x_m + y_m * y_m);
        if (!(distance_m > 0.5F * pitch_m)) continue;
        const int bin = rays_.bin_of(x_m, y_m);
        if (!rays_.touched(bin)) continue;
        const RaySight& sight = rays_.sight(bin, rays_.ring_of(distance_m));
        MapCell& cell = map(row, column);
        const auto sensor_z_m = static_cast<float>(
            origin_map_m.z() - off.at((window.min.x + column + 0.5) * cell_m, (window.min.y + row + 0.5) * cell_m));
        cell.shadowed = cell.shadowed || sight.shadowed;
        if (sight.ceiling_slope == std::numeric_limits<float>::infinity()) continue;
        lower_ceiling(sight, distance_m, sensor_z_m, pitch_m, cell);
        if (!cell.measured() || points.count(row, column) > 0) continue;
        const float passed_m = sensor_z_m + sight.ceiling_slope * distance_m;
        const float sure_m = config_.margin_m + 2.0F * std::sqrt(cell.relief_m2) +
                             kSeenThroughSigmas * std::sqrt(height_variance_m2(cell, pitch_m));
        if (passed_m < cell.height_m - sure_m)
          passed_[static_cast<std::size_t>(row) * static_cast<std::size_t>(window.columns) +
                  static_cast<std::size_t>(column)] = 1;
      }
    }
  });
}

void Visibility::update(const PointFrame& frame, const CellPoints& points, const HeightPlane& off, Executor& executor,
                        RollingGrid<MapCell>& map) {
  const LatticeWindow& window = map.window();
  passed_.assign(static_cast<std::size_t>(window.rows) * static_cast<std::size_t>(window.columns), 0);
  for (std::size_t begin = 0; begin < frame.sensor_m.size();) {
    const std::size_t end = piece_end(frame, begin, static_cast<float>(config_.cell_m));
    if (frame.row_begin[end] > frame.row_begin[begin]) {
      look_from(frame, begin, end, executor);
      const Eigen::Vector3f& middle = frame.sensor_m[begin + (end - begin) / 2];
      mark(frame.anchor_map_m + middle.cast<double>(), points, off, executor, map);
    }
    begin = end;
  }
  std::size_t i = 0;
  for (int row = 0; row < window.rows; ++row) {
    for (int column = 0; column < window.columns; ++column, ++i) {
      if (passed_[i] == 0) continue;
      MapCell& cell = map(row, column);
      if (++cell.seen_through < kFramesToForget) continue;
      cell.forget_height();
    }
  }
}

}  // namespace scree::mapping
