#include "tests/bench/map/truth/scene_truth.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "tests/bench/map/truth/baselines.hpp"
#include "tests/bench/map/truth/vehicle_truth.hpp"

namespace scree::bench {
namespace {

constexpr int kNodesPerCell = 4;
constexpr float kFar_m = 2.0F;

float cell_mean(const Grid<float>& nodes, int row, int column) {
  float sum = 0.0F;
  for (int r = 0; r <= kNodesPerCell; ++r)
    for (int c = 0; c <= kNodesPerCell; ++c) {
      const float weight = (r % kNodesPerCell == 0 ? 0.5F : 1.0F) * (c % kNodesPerCell == 0 ? 0.5F : 1.0F);
      sum += weight * nodes(row * kNodesPerCell + r, column * kNodesPerCell + c);
    }
  return sum / (kNodesPerCell * kNodesPerCell);
}

bool any_node(const Grid<std::uint8_t>& nodes, int row, int column) {
  for (int r = 0; r <= kNodesPerCell; ++r)
    for (int c = 0; c <= kNodesPerCell; ++c)
      if (nodes(row * kNodesPerCell + r, column * kNodesPerCell + c) != 0) return true;
  return false;
}

/// Chebyshev distances: two passes over the neighbours that come before and after are exact.
void spread_distances(Grid<float>& distance_m) {
  constexpr int kBefore[4][2] = {{0, -1}, {-1, -1}, {-1, 0}, {-1, 1}};
  const auto pull = [&](int row, int column, int sign) {
    for (const auto& [dr, dc] : kBefore) {
      if (!distance_m.contains(row + sign * dr, column + sign * dc)) continue;
      const float there = distance_m(row + sign * dr, column + sign * dc);
      distance_m(row, column) = std::min(distance_m(row, column), there + static_cast<float>(kMapCell_m));
    }
  };
  for (int r = 0; r < distance_m.rows(); ++r)
    for (int c = 0; c < distance_m.columns(); ++c) pull(r, c, 1);
  for (int r = distance_m.rows() - 1; r >= 0; --r)
    for (int c = distance_m.columns() - 1; c >= 0; --c) pull(r, c, -1);
}

void judge_vehicle(const VehicleOnGround& vehicle, int row, int column, SceneTruth& truth) {
  const double x_m = (column + 0.5) * kMapCell_m, y_m = (row + 0.5) * kMapCell_m;
  float worst = 0.0F, best = std::numeric_limits<float>::infinity();
  for (int k = 0; k < kTruthHeadings; ++k) {
    const float share = vehicle.at(x_m, y_m, std::numbers::pi * k / kTruthHeadings).largest();
    worst = std::isnan(share) || share > worst ? share : worst;
    best = std::isnan(share) || share < best ? share : best;
    if (std::isnan(share)) break;
  }
  truth.worst_share(row, column) = worst;
  truth.best_share(row, column) = best;
}

}  // namespace

SceneTruth scene_truth(const Ground& ground, const mapping::VehicleConfig& vehicle,
                       const std::optional<LatticeWindow>& judged) {
  const Grid<float>& nodes = ground.nodes.height_m;
  const int rows = (nodes.rows() - 1) / kNodesPerCell, columns = (nodes.columns() - 1) / kNodesPerCell;
  const auto lattice = [](double outer_m) {
    return static_cast<std::int32_t>(std::lround((outer_m + 0.5 * kNode_m) / kMapCell_m));
  };
  SceneTruth truth;
  truth.cells = {{lattice(ground.nodes.x_min_m), lattice(ground.nodes.y_min_m)}, rows, columns};
  truth.height_m.assign(rows, columns, 0.0F);
  truth.worst_share.assign(rows, columns, std::numeric_limits<float>::quiet_NaN());
  truth.best_share = truth.worst_share;
  truth.object_m.assign(rows, columns, kFar_m);
  truth.ditch.assign(rows, columns, 0);
  const VehicleOnGround on_ground(nodes, kNode_m, vehicle);
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column) {
      truth.height_m(row, column) = cell_mean(nodes, row, column);
      truth.ditch(row, column) = any_node(ground.ditch, row, column) ? 1 : 0;
      if (truth.ditch(row, column) != 0 || any_node(ground.rock, row, column)) truth.object_m(row, column) = 0.0F;
      const CellIndex cell{truth.cells.min.x + column, truth.cells.min.y + row};
      if (!judged || judged->contains(cell)) judge_vehicle(on_ground, row, column, truth);
    }
  spread_distances(truth.object_m);
  truth.cell_share = footprint_share(truth.height_m, kMapCell_m, vehicle);
  return truth;
}

}  // namespace scree::bench
