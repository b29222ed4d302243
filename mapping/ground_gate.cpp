#include "mapping/ground_gate.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/executor.hpp"

namespace scree::mapping {

namespace {

constexpr int kSide = 2 * kGateReach_cells + 1;
constexpr int kLeastReturns = 4;
constexpr float kHurst = 0.5F;

struct Neighbour {
  float height_m = 0.0F;
  float distance_m = 0.0F;
  int hits = 0;  ///< of this frame
};

struct Neighbourhood {
  std::array<Neighbour, kSide * kSide> cells;
  int count = 0;
  int seen = 0;  ///< by this frame
  int hits = 0;  ///< of this frame
};

Neighbourhood around(const CellReturn& centre, const FrameReturns& frame, const RollingGrid<MapCell>& map,
                     float cell_m) {
  Neighbourhood out;
  const LatticeWindow& window = map.window();
  for (int dy = -kGateReach_cells; dy <= kGateReach_cells; ++dy)
    for (int dx = -kGateReach_cells; dx <= kGateReach_cells; ++dx) {
      const int row = centre.row + dy, column = centre.column + dx;
      if ((dx == 0 && dy == 0) || row < 0 || column < 0 || row >= window.rows || column >= window.columns) continue;
      const CellReturn* seen = frame.at(row, column);
      const MapCell& cell = map(row, column);
      if (seen == nullptr && !cell.measured()) continue;
      const float distance_m = cell_m * std::sqrt(static_cast<float>(dx * dx + dy * dy));
      const int hits = seen != nullptr ? seen->ground.hits : 0;
      out.cells[static_cast<std::size_t>(out.count++)] = {cell.measured() ? cell.height_m : seen->ground.height_m,
                                                          distance_m, hits};
      out.seen += seen != nullptr ? 1 : 0;
      out.hits += hits;
    }
  return out;
}

template <class Value>
float median_of(const Neighbourhood& around, Value value) {
  std::array<float, kSide * kSide> values;
  for (int i = 0; i < around.count; ++i)
    values[static_cast<std::size_t>(i)] = value(around.cells[static_cast<std::size_t>(i)]);
  const auto middle = values.begin() + around.count / 2;
  std::nth_element(values.begin(), middle, values.begin() + around.count);
  return *middle;
}

}  // namespace

float GateLaw::change_m2(CellIndex cell, float lag_m) const {
  if (last_ != nullptr && last_->window.contains(cell)) {
    const int row = cell.y - last_->window.min.y, column = cell.x - last_->window.min.x;
    const float dimension = last_->dimension(row, column), amplitude_m = last_->amplitude_m(row, column);
    if (std::isfinite(dimension) && std::isfinite(amplitude_m))
      return amplitude_m * amplitude_m * std::pow(lag_m, 2.0F * (3.0F - dimension));
  }
  return kGateAmplitude_m * kGateAmplitude_m * std::pow(lag_m, 2.0F * kHurst);
}

bool GroundGate::refuses(const CellReturn& seen, const FrameReturns& frame, const RollingGrid<MapCell>& map,
                         float cell_m, const GateLaw& law) {
  const Neighbourhood near = around(seen, frame, map, cell_m);
  if (near.count < kGateNeighbours) return false;
  const float z_m = seen.ground.height_m;
  const float ground_m = median_of(near, [](const Neighbour& n) { return n.height_m; });
  const float lag_m = median_of(near, [](const Neighbour& n) { return n.distance_m; });
  const LatticeWindow& window = map.window();
  const CellIndex cell{window.min.x + seen.column, window.min.y + seen.row};
  const float own_m2 = own_variance_m2(seen.ground, cell_m);
  const float miss_m = std::abs(z_m - ground_m);
  if (miss_m * miss_m <= kGateSigmas * kGateSigmas * (own_m2 + law.change_m2(cell, lag_m))) return false;
  if (seen.ground.hits >= kLeastReturns && near.seen > 0 && 2 * seen.ground.hits * near.seen >= near.hits) return false;
  int beside = 0;
  for (int i = 0; i < near.count; ++i) {
    const Neighbour& n = near.cells[static_cast<std::size_t>(i)];
    const float off_m = std::abs(n.height_m - z_m);
    if (3.0F * off_m >= miss_m) continue;
    beside += off_m * off_m <= 4.0F * (own_m2 + law.change_m2(cell, n.distance_m)) ? 1 : 0;
  }
  return beside < 2;
}

void GroundGate::judge(const FrameReturns& frame, const RollingGrid<MapCell>& map, float cell_m, const GateLaw& law,
                       Executor& executor) {
  const LatticeWindow& window = map.window();
  if (refused_.rows() != window.rows || refused_.columns() != window.columns)
    refused_.assign(window.rows, window.columns, 0);
  for_rows(executor, window.rows, [&](int begin, int end) {
    for (int row = begin; row < end; ++row)
      for (const CellReturn& seen : frame.of_row(row))
        refused_(row, seen.column) =
            !map(row, seen.column).measured() && refuses(seen, frame, map, cell_m, law) ? 1 : 0;
  });
}

}  // namespace scree::mapping
