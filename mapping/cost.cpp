#include "mapping/cost.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "mapping/snapshot.hpp"

namespace scree::mapping {

namespace {

// A wheel or the belly meets the worst of many height changes: they are judged at two standard deviations. The track
// spans one, and the slope already holds the ground's measured tilt: one deviation.
constexpr double kDeviations = 2.0;

// D and amplitude are those of a window that a trunk or a boulder a metre away may fill. Where the footprint itself is
// measured, no second difference in it is believed beyond that of white heights (√6 times their rms) with twice the
// measured deviation: with the seven degrees of freedom that rough ground leaves, a sample's rms falls below half the
// true one in 3 % of places.
constexpr double kDeviationTrust = 2.0;

/// rms second difference over `lag_m`, by the window's law, bounded by what the footprint shows.
double bend_m(const GroundShape& ground, double lag_m) {
  const double by_law_m = ground.roughness->rms_bend_m(lag_m);
  if (std::isnan(ground.deviation_m)) return by_law_m;
  return std::min(by_law_m, kDeviationTrust * std::sqrt(6.0) * static_cast<double>(ground.deviation_m));
}

/// rms height change over `lag_m` that no plane explains (the slope is a hazard of its own): the second difference over
/// the lag in units of what white heights would show, √3 times their rms change.
double relief_m(const GroundShape& ground, double lag_m) {
  return bend_m(ground, lag_m) / std::numbers::sqrt3;
}

/// rms height of the ground under the middle of a span of `length_m` above the line between its ends.
double crown_m(const GroundShape& ground, double length_m) {
  return 0.5 * bend_m(ground, 0.5 * length_m);
}

double combined(const Hazards& h) {
  double ease = 1.0;
  for (const double hazard : {h.slope, h.step, h.roughness, h.roll, h.clearance}) ease *= 1.0 - hazard * hazard;
  return 1.0 - ease;
}

}  // namespace

Hazards hazards(const GroundShape& ground, const VehicleConfig& vehicle) {
  Hazards h;
  h.slope = static_cast<double>(ground.slope_rad) / std::min(vehicle.max_pitch_rad, vehicle.max_roll_rad);
  h.step = static_cast<double>(ground.step_m) / vehicle.max_step_m;
  if (!ground.roughness) return h;
  h.roughness = kDeviations * relief_m(ground, vehicle.wheel_radius_m) / vehicle.max_step_m;
  h.roll = std::atan(relief_m(ground, vehicle.track_m) / vehicle.track_m) / vehicle.max_roll_rad;
  h.clearance = kDeviations * crown_m(ground, vehicle.wheelbase_m) / vehicle.clearance_m;
  return h;
}

std::uint8_t cell_cost(const GroundShape& ground, const VehicleConfig& vehicle) {
  if (ground.state == CellState::possible_drop) return kCostLethal;
  if (ground.state != CellState::measured && ground.state != CellState::reconstructed) return kCostUnknown;
  if (!std::isfinite(ground.slope_rad) || !std::isfinite(ground.step_m)) return kCostUnknown;
  const Hazards h = hazards(ground, vehicle);
  if (std::max({h.slope, h.step, h.roughness, h.roll, h.clearance}) >= 1.0) return kCostLethal;
  const auto scaled = static_cast<std::uint8_t>(std::lround(kCostMax * combined(h)));
  const std::uint8_t floor_cost = std::max(ground.state == CellState::reconstructed ? kReconstructedFloor : kCostFree,
                                           ground.roughness ? kCostFree : kUnknownRoughnessFloor);
  return std::max(scaled, floor_cost);
}

}  // namespace scree::mapping
