#pragma once
// Kept pixels → points, each row with its own pose.

#include <cstdint>
#include <vector>

#include "drivers/frame/pixel_state.hpp"
#include "drivers/frame/point_frame.hpp"
#include "drivers/frame/ray_tables.hpp"
#include "drivers/frame/row_poses.hpp"

namespace scree {

/// Writes the arrays of `out` (anchor, points, row_begin, sensor_m), row after row, columns from the left.
void write_points(const RayTables& tables, const RowPoses& poses, const Grid<PixelState>& state,
                  const Grid<float>& range_m, Executor& executor, PointFrame& out);

}  // namespace scree
