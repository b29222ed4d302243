#pragma once
// What a careful engineer would do without Scree: fill the gaps smoothly, then judge the ground's shape.

#include "core/grid.hpp"
#include "mapping/vehicle.hpp"

namespace scree::bench {

/// The membrane through the known heights: each unknown cell becomes the mean of its four neighbours (residual below
/// 0.1 mm), the rim of the grid is free. NaN = unknown; a grid without a known cell stays as it is.
Grid<float> smooth_fill(const Grid<float>& height_m);

/// Highest less lowest height within `radius_m` of the cell, m.
Grid<float> relief(const Grid<float>& height_m, double cell_m, double radius_m);

/// Metres of relief to 0 … 1: relief / (relief + 0.2 m).
Grid<float> relief_score(Grid<float> relief_m);

/// The rules of leggedrobotics/traversability_estimation, restated: a hazard each for slope, step and roughness as a
/// share of its critical value, at most 1, and their weighted mean.
struct PlaneRules {
  double slope_radius_m = 0.15;  ///< of the disc of the plane's fit; the published 0.05 m is less than a cell
  double step_radius_m = 0.15;   ///< of both windows: height differences, and the largest of them
  double roughness_radius_m = 0.15;
  double slope_critical_rad = 1.0;
  double step_critical_m = 0.12;
  double roughness_critical_m = 0.05;
  double slope_weight = 1.0, step_weight = 1.0, roughness_weight = 1.0;
};

/// 0 = good ground, 1 = critical in everything. slope: of the least-squares plane; roughness: rms deviation from the
/// plane of its own radius; step: the largest relief in the window. The original lets a step count nothing unless four
/// cells of the window are above the critical one; its ranking is better without that.
Grid<float> plane_hazard(const Grid<float>& height_m, double cell_m, const PlaneRules& rules);

/// The vehicle of vehicle_truth put onto the heights as they are: largest share of a limit at the worst of 16 headings.
/// What Scree's risk is without uncertainty. NaN where the footprint leaves the grid.
Grid<float> footprint_share(const Grid<float>& height_m, double cell_m, const mapping::VehicleConfig& vehicle);

}  // namespace scree::bench
