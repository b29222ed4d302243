#pragma once
// One finished map, immutable once it leaves the mapper.

#include <cstdint>
#include <vector>

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
  Grid<float> elevation_m;           ///< measured: fused height; reconstructed: draw 0 of the posterior
  Grid<float> elevation_mean_m;      ///< measured: fused height; reconstructed: mean of the posterior
  Grid<float> elevation_sigma_m;     ///< one standard deviation of elevation_mean_m's error
  std::vector<Grid<float>> draws_m;  ///< posterior draws that are alike from frame to frame, wherever there is a mean
  /// Probability that the vehicle, centred on the cell, violates one of its limits: at the worst heading, and by sector
  /// k of headings about (k + ½)·180°/n, n = heading_risk.size(), from the map's x axis to its y axis; driving
  /// backwards is the same.
  Grid<float> risk;
  std::vector<Grid<float>> heading_risk;
  Grid<float> cell_age_s;  ///< data_time less the time of the cell's newest return; NaN where not measured
  Grid<float> dimension;   ///< D; NaN where there is too little data
  Grid<float> dimension_sigma;
  Grid<std::uint8_t> dimension_flags;  ///< bits of fractal::DimensionFlag
  Grid<float> amplitude_m;             ///< rms height change at 1 m; with D it gives every other lag
  Grid<float> slope_rad;
  Grid<float> step_m;
  Grid<std::uint16_t> hits;

  std::size_t measured_cells() const;
};

}  // namespace scree::mapping
