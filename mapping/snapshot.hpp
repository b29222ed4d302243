#pragma once
// One finished map, immutable once it leaves the mapper.

#include <cstdint>

#include "core/cell_state.hpp"
#include "core/grid.hpp"
#include "core/pose.hpp"
#include "core/time.hpp"

namespace scree::mapping {

inline constexpr std::uint8_t kCostFree = 0;
inline constexpr std::uint8_t kCostMax = 252;     ///< 1 … 252 scaled
inline constexpr std::uint8_t kCostLethal = 254;  ///< 253 is left to the planner
inline constexpr std::uint8_t kCostUnknown = 255;

/// All grids have the window's shape; row 0 is the smallest y. NaN = unknown, and `state` says why.
struct MapSnapshot {
  std::uint32_t revision = 0;
  double cell_m = 0.1;
  LatticeWindow window;
  Time data_time;          ///< of the newest sample contained
  MonotonicTime received;  ///< when that sample's frame was delivered
  Pose T_map_body;

  Grid<std::uint8_t> cost;
  Grid<CellState> state;
  Grid<float> elevation_m;        ///< measured: fused height; reconstructed: one posterior draw
  Grid<float> elevation_sigma_m;  ///< measured cells only, for now
  Grid<float> dimension;          ///< D; NaN where there is too little data
  Grid<float> dimension_sigma;
  Grid<std::uint8_t> dimension_flags;  ///< bits of fractal::DimensionFlag
  Grid<float> amplitude_m;             ///< rms height change at 1 m; with D it gives every other lag
  Grid<float> slope_rad;
  Grid<float> step_m;
  Grid<std::uint16_t> hits;

  std::size_t measured_cells() const;
};

}  // namespace scree::mapping
