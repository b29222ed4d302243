#include "mapping/frame_returns.hpp"

#include <algorithm>
#include <cmath>

#include "core/executor.hpp"

namespace scree::mapping {

namespace {

float mean_of(std::span<const float> values) {
  float sum = 0.0F;
  for (const float value : values) sum += value;
  return sum / static_cast<float>(values.size());
}

const MapCell* measured_at(const RollingGrid<MapCell>& map, int row, int column) {
  const LatticeWindow& window = map.window();
  if (row < 0 || column < 0 || row >= window.rows || column >= window.columns) return nullptr;
  const MapCell& cell = map(row, column);
  return cell.measured() ? &cell : nullptr;
}

/// Squared slope between two stored heights two cells apart, less what their noise makes of it.
float axis_slope2(const MapCell* low, const MapCell* high, float cell_m) {
  if (low == nullptr || high == nullptr) return kSlopePrior * kSlopePrior;
  const float rise_m = high->height_m - low->height_m;
  const float noise_m2 = low->noise_variance_m2 + high->noise_variance_m2;
  return std::max(0.0F, rise_m * rise_m - noise_m2) / (4.0F * cell_m * cell_m);
}

float slope2_at(const RollingGrid<MapCell>& map, int row, int column, float cell_m) {
  return axis_slope2(measured_at(map, row, column - 1), measured_at(map, row, column + 1), cell_m) +
         axis_slope2(measured_at(map, row - 1, column), measured_at(map, row + 1, column), cell_m);
}

/// Variance of a height at (x, y) from the body, of the pose's error.
float pose_variance_m2(const PoseVariance& pose, double x_m, double y_m, float slope2) {
  const auto& position = pose.position_m2;
  const auto& attitude = pose.attitude_rad2;
  const double tilt = attitude.x() * y_m * y_m + attitude.y() * x_m * x_m;
  const double horizontal = 0.5 * (position.x() + position.y() + attitude.z() * (x_m * x_m + y_m * y_m));
  return static_cast<float>(position.z() + tilt + static_cast<double>(slope2) * horizontal);
}

}  // namespace

void FrameReturns::gather_row(int row, const PointFrame& frame, const PoseVariance& pose, CellPoints& points,
                              const RollingGrid<MapCell>& map, const GroundConfig& config) {
  const LatticeWindow& window = map.window();
  const double anchor_z_m = frame.anchor_map_m.z();
  const double cell_m = static_cast<double>(config.cell_m);
  const double y_m = (window.min.y + row + 0.5) * cell_m - frame.T_map_body.translation_m.y();
  std::uint32_t next = row_begin_[static_cast<std::size_t>(row)];
  for (int column = 0; column < window.columns; ++column) {
    index_(row, column) = -1;
    if (points.count(row, column) == 0) continue;
    index_(row, column) = static_cast<std::int32_t>(next);
    CellReturn& out = returns_[next++];
    out.row = row;
    out.column = column;
    const MapCell& cell = map(row, column);
    StoredHeight stored;
    if (cell.measured())
      stored = {static_cast<float>(static_cast<double>(cell.height_m) - anchor_z_m),
                height_variance_m2(cell, config.cell_m)};
    const float horizontal_m2 = mean_of(points.horizontal_variances_m2(row, column));
    out.ground = ground_return(points.heights_m(row, column), points.variances_m2(row, column), stored, config);
    out.slope2 = slope2_at(map, row, column, config.cell_m);
    const double x_m = (window.min.x + column + 0.5) * cell_m - frame.T_map_body.translation_m.x();
    out.ground.height_m = static_cast<float>(static_cast<double>(out.ground.height_m) + anchor_z_m);
    out.ground.bottom_m = static_cast<float>(static_cast<double>(out.ground.bottom_m) + anchor_z_m);
    out.ground.place_variance_m2 = out.slope2 * horizontal_m2;
    out.ground.shared_variance_m2 = pose_variance_m2(pose, x_m, y_m, out.slope2);
  }
}

void FrameReturns::gather(const PointFrame& frame, const PoseVariance& pose, CellPoints& points,
                          const RollingGrid<MapCell>& map, const GroundConfig& config, Executor& executor) {
  const int rows = points.rows();
  if (index_.rows() != rows || index_.columns() != points.columns()) index_.assign(rows, points.columns(), -1);
  row_begin_.assign(static_cast<std::size_t>(rows) + 1, 0);
  for_rows(executor, rows, [&](int begin, int end) {
    for (int row = begin; row < end; ++row)
      for (int column = 0; column < points.columns(); ++column)
        row_begin_[static_cast<std::size_t>(row) + 1] += points.count(row, column) > 0 ? 1U : 0U;
  });
  for (std::size_t row = 0; row < static_cast<std::size_t>(rows); ++row) row_begin_[row + 1] += row_begin_[row];
  returns_.reserve(index_.size());  // once: a later frame may hit more cells
  returns_.resize(row_begin_.back());
  for_rows(executor, rows, [&](int begin, int end) {
    for (int row = begin; row < end; ++row) gather_row(row, frame, pose, points, map, config);
  });
}

std::span<const CellReturn> FrameReturns::of_row(int row) const {
  const auto begin = row_begin_[static_cast<std::size_t>(row)], end = row_begin_[static_cast<std::size_t>(row) + 1];
  return std::span(returns_).subspan(begin, end - begin);
}

const CellReturn* FrameReturns::at(int row, int column) const {
  if (!index_.contains(row, column) || index_(row, column) < 0) return nullptr;
  return &returns_[static_cast<std::size_t>(index_(row, column))];
}

}  // namespace scree::mapping
