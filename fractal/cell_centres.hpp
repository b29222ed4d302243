#pragma once
// Cell means of returns at known places, moved to the centres of their cells.

#include "core/grid.hpp"

namespace scree::fractal {

/// The mean of a few returns stands at their mean place, not at the centre of the cell: on a slope g that is an error
/// of g·offset, which looks like noise to second differences. Each height is moved along the least-squares plane of the
/// known cells (at their mean places) in the window of (2·radius + 1)² around it. Planes come out exact. Windows with
/// fewer than 5 cells, or cells on one line, leave their height as it is. `dx_cells`, `dy_cells`: mean place relative
/// to the centre, −½ … ½. Three grids of one shape, NaN heights = unknown. Cost: O(cells), running sums in double.
void move_to_centres(const Grid<float>& dx_cells, const Grid<float>& dy_cells, int radius_cells, Grid<float>& height_m);

}  // namespace scree::fractal
