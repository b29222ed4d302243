#pragma once
// Speckle and mixed pixels, told by a pixel's nearest neighbours alone.

#include "core/executor.hpp"
#include "core/grid.hpp"
#include "drivers/frame/image_edges.hpp"
#include "drivers/frame/pixel_state.hpp"

namespace scree {

/// Marks kept pixels of `state`:
/// mixed, when along a row or column they lie inside a monotone run of two or three steps too steep for any surface
/// seen at more than the grazing angle, and the image is smooth (or ends) on both sides of the run;
/// speckle, when fewer than two of the four neighbours are joined, or none is close.
/// Continuing grazing ground has long runs and stays. Rows are independent.
void reject_by_neighbours(const Grid<float>& range_m, const ImageEdges& edges, const RayTables& tables,
                          Executor& executor, Grid<PixelState>& state);

}  // namespace scree
