#pragma once
// What one frame says of each cell that it hit, before it meets the map.

#include <cstdint>
#include <span>
#include <vector>

#include "core/executor.hpp"
#include "core/rolling_grid.hpp"
#include "drivers/frame/point_frame.hpp"
#include "mapping/cell_points.hpp"
#include "mapping/ground_return.hpp"
#include "mapping/map_cell.hpp"

namespace scree::mapping {

/// Height in the map frame; row and column are the window's.
struct CellReturn {
  std::int32_t row = 0;
  std::int32_t column = 0;
  GroundReturn ground;
  float slope2 = 0.0F;  ///< squared slope of the ground here, from the map's heights around or the prior
};

// Slope along one axis where the map knows none: of fBm with 0.08 m at 1 m and D 2.3 over one cell of 0.1 m.
inline constexpr float kSlopePrior = 0.16F;

/// Row-parallel; keeps its buffers. What ground_return says of every cell, and beside it the variance of a return that
/// lies beside its place, slope² · horizontal variance, and that of the pose at the cell: z, its attitude times the
/// distance from the body, slope² · its horizontal part.
class FrameReturns {
 public:
  /// Cost: O(cells + points).
  void gather(const PointFrame& frame, const PoseVariance& pose, CellPoints& points, const RollingGrid<MapCell>& map,
              const GroundConfig& config, Executor& executor);

  std::span<CellReturn> all() { return returns_; }
  std::span<const CellReturn> all() const { return returns_; }
  /// Those of one row of the window, by growing column.
  std::span<const CellReturn> of_row(int row) const;
  /// The frame's return in a cell of the window; null = none.
  const CellReturn* at(int row, int column) const;

 private:
  void gather_row(int row, const PointFrame& frame, const PoseVariance& pose, CellPoints& points,
                  const RollingGrid<MapCell>& map, const GroundConfig& config);

  std::vector<CellReturn> returns_;
  std::vector<std::uint32_t> row_begin_;  ///< rows + 1
  Grid<std::int32_t> index_;              ///< -1 = none
};

}  // namespace scree::mapping
