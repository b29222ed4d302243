#pragma once
// What is true of every map cell of a ground.

#include <optional>

#include "core/grid.hpp"
#include "mapping/vehicle.hpp"
#include "tests/bench/map/truth/ground.hpp"

namespace scree::bench {

inline constexpr double kMapCell_m = 0.1;

/// Grids over `cells`, the lattice cells of kMapCell_m that lie inside the ground.
struct SceneTruth {
  LatticeWindow cells;
  Grid<float> height_m;     ///< mean of the surface in the cell, exactly
  Grid<float> worst_share;  ///< of a limit of the vehicle centred on the cell, at its worst heading; NaN at the rim
  Grid<float> best_share;   ///< at its best heading
  /// worst_share of the vehicle on height_m instead of the nodes: all that a perfect map of cells would know.
  Grid<float> cell_share;
  Grid<float> object_m;  ///< Chebyshev distance from the cell's centre to a node of a rock or the ditch, at most 2 m
  Grid<std::uint8_t> ditch;  ///< a node of the ditch is in the cell

  bool impassable(int row, int column) const { return worst_share(row, column) > 1.0F; }
  bool impassable_everywhere(int row, int column) const { return best_share(row, column) > 1.0F; }
};

/// Shares outside `judged` are NaN. Cost: 50 µs a judged cell.
SceneTruth scene_truth(const Ground& ground, const mapping::VehicleConfig& vehicle,
                       const std::optional<LatticeWindow>& judged = {});

}  // namespace scree::bench
