#pragma once
// The rolling map as plain grids, row 0 at the smallest y: what the layers are computed from.

#include <cstdint>

#include "core/executor.hpp"
#include "core/grid.hpp"
#include "core/rolling_grid.hpp"
#include "mapping/map_cell.hpp"

namespace scree::mapping {

struct GroundLayers {
  Grid<float> height_m;           ///< NaN = unmeasured
  Grid<float> noise_variance_m2;  ///< of the mean, independent range noise alone; 0 where unmeasured
  Grid<float> variance_m2;        ///< of the height as the cell's mean height; 0 where unmeasured
  Grid<float> relief_m2;          ///< variance of single returns beyond their noise
  Grid<float> ceiling_m;          ///< +inf = no ray crossed
  Grid<float> lip_m;
  Grid<float> cell_age_s;  ///< since a return was last fused; NaN = unmeasured
  Grid<std::uint16_t> hits;
  Grid<std::uint16_t> support;  ///< random_support(hits)
  Grid<std::uint8_t> measured;  ///< 1 = measured
  Grid<std::uint8_t> shadowed;

  /// Copies every cell of `map`, row-parallel. `now_ms`: on the clock of MapCell::fused_ms.
  void unroll(const RollingGrid<MapCell>& map, double cell_m, Executor& executor, std::uint32_t now_ms = 0);

  /// variance_m2 again, now that a law tells the variance of the ground within each cell.
  void judge_variance(const RollingGrid<MapCell>& map, const Grid<float>& relief_m2_by_law, Executor& executor);

 private:
  void shape(int rows, int columns);
};

}  // namespace scree::mapping
