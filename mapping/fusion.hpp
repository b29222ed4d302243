#pragma once
// A frame's returns into the rolling map.

#include <cstdint>
#include <vector>

#include "core/executor.hpp"
#include "core/rolling_grid.hpp"
#include "mapping/frame_returns.hpp"
#include "mapping/ground_gate.hpp"
#include "mapping/ground_return.hpp"
#include "mapping/map_cell.hpp"

namespace scree::mapping {

/// What became of the points inside the window: their number is fused + outlier + other_surface.
struct FusionCounts {
  std::uint64_t fused = 0;
  std::uint64_t outlier = 0;        ///< contradicted the stored height, or the ground around
  std::uint64_t unsupported = 0;    ///< among `outlier`: the ground around, where nothing was stored
  std::uint64_t other_surface = 0;  ///< canopy, overhang, or the other side of an edge inside the cell
};

/// A stored height that lies overhang_m or more above what rays of this many frames passed below is no ground and is
/// forgotten; so is one that they pass below without hitting the cell (visibility.hpp).
inline constexpr int kFramesToForget = 5;

/// A stored height that frames contradict this many times in a row is replaced by what they say.
inline constexpr int kFramesToReplace = 3;
/// One frame is enough when it has this many times the returns that the stored height rests on: a few mixed pixels that
/// hung in the shadow of an edge must not outvote the ground once it is seen from near, which may be in one frame only.
inline constexpr int kReturnsToReplace = 4;

/// Folds one cell's returns of one frame (heights in the map frame) into the stored cell. Heights that agree within
/// `outlier_sigmas` are averaged with weights 1/variance; the noise of the result is propagated, `hits` adds up and the
/// relief is pooled. What lies `overhang_m` or more above the stored height, or above a ray that crossed the cell, is
/// another surface and no contradiction.
FusionCounts fuse_cell(const GroundReturn& frame, const GroundConfig& config, MapCell& cell);

/// Every cell of the window, row-parallel.
class Fusion {
 public:
  explicit Fusion(const GroundConfig& config) : config_(config) {}
  /// `now_ms`: the frame's time on the clock of MapCell::fused_ms. `law`: of the ground, for what the ground around
  /// says of a cell that holds nothing yet. Cost: O(cells hit).
  FusionCounts fuse(FrameReturns& frame, std::uint32_t now_ms, const GateLaw& law, Executor& executor,
                    RollingGrid<MapCell>& map);
  /// Every point of the frame is an outlier: it contradicts the map as a whole.
  static FusionCounts refuse(const FrameReturns& frame);

 private:
  FusionCounts fuse_row(FrameReturns& frame, int row, std::uint32_t now_ms, RollingGrid<MapCell>& map) const;

  GroundConfig config_;
  GroundGate gate_;
  std::vector<FusionCounts> row_counts_;
};

}  // namespace scree::mapping
