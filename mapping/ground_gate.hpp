#pragma once
// Returns that no ground around them explains.

#include <cstdint>

#include "core/executor.hpp"
#include "core/grid.hpp"
#include "core/rolling_grid.hpp"
#include "mapping/frame_returns.hpp"
#include "mapping/map_cell.hpp"
#include "mapping/snapshot.hpp"

namespace scree::mapping {

/// The law of the ground by cell: that of the last snapshot where it has one, else a rough one.
class GateLaw {
 public:
  /// `last` may be null and must outlive this.
  explicit GateLaw(const MapSnapshot* last = nullptr) : last_(last) {}
  /// Variance of the height change over `lag_m` at a cell of the world's lattice.
  float change_m2(CellIndex cell, float lag_m) const;

 private:
  const MapSnapshot* last_;
};

// Where nothing is known of the ground: as rough as 0.2 m at 1 m, H = 1/2.
inline constexpr float kGateAmplitude_m = 0.2F;
inline constexpr int kGateReach_cells = 3;
inline constexpr int kGateNeighbours = 4;  ///< fewer predict nothing
inline constexpr float kGateSigmas = 4.0F;

/// Whether a cell that the map does not hold yet may take what a frame says of it. The gate stands at the scale of the
/// ground, as fractal/reconstruction/outlier_gate.hpp has it: what the cells within three say (the map's height, else
/// the frame's) is their median m, and they leave open s² = R + the law's change over their median distance, R the
/// variance of the return. Refused is |z − m| > 4 s, unless
/// - two of those cells go with it: they differ from it by less than a third of what m does, and by at most 2 s of the
///   change over their distance; a rock, a wall and the far side of an edge have such neighbours, or
/// - it has at least 4 returns and half as many as those cells have on average: a thin thing, well seen.
/// What a frame sees is judged before any of it is fused, so the result does not depend on order.
class GroundGate {
 public:
  /// Cost: O(48 · cells that were hit and not stored).
  void judge(const FrameReturns& frame, const RollingGrid<MapCell>& map, float cell_m, const GateLaw& law,
             Executor& executor);
  bool refused(int row, int column) const { return refused_(row, column) != 0; }

 private:
  static bool refuses(const CellReturn& seen, const FrameReturns& frame, const RollingGrid<MapCell>& map, float cell_m,
                      const GateLaw& law);

  Grid<std::uint8_t> refused_;  ///< valid where the frame hit
};

}  // namespace scree::mapping
