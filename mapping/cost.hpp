#pragma once
// From the shape of the ground to a cost for one vehicle. docs/mapping.md tells planner authors what a cost means.

#include <cstdint>
#include <limits>
#include <optional>

#include "core/cell_state.hpp"
#include "fractal/surface.hpp"
#include "mapping/vehicle.hpp"

namespace scree::mapping {

/// Ground that was not measured is never cheaper than this.
inline constexpr std::uint8_t kReconstructedFloor = 64;
/// Measured ground whose roughness nobody could estimate is never cheaper than this.
inline constexpr std::uint8_t kUnknownRoughnessFloor = 32;

struct GroundShape {
  CellState state = CellState::never_seen;
  float slope_rad = 0.0F;  ///< NaN = unknown
  float step_m = 0.0F;
  std::optional<fractal::FractalLaw> roughness;  ///< of a window that may hold other ground than this, too
  /// rms deviation of the measured heights from the plane of the footprint; NaN = not measured well enough
  float deviation_m = std::numeric_limits<float>::quiet_NaN();
};

/// Shares of what the vehicle can bear: 0 = nothing, 1 = its limit.
struct Hazards {
  double slope = 0.0;      ///< slope / min(max_pitch, max_roll): the heading is not known
  double step = 0.0;       ///< step / max_step
  double roughness = 0.0;  ///< twice the rms relief over a wheel radius / max_step
  double roll = 0.0;       ///< rms relief over the track, as an angle / max_roll
  double clearance = 0.0;  ///< twice the rms crown of the ground between the axles / clearance
};
Hazards hazards(const GroundShape& ground, const VehicleConfig& vehicle);

/// 255 for never_seen, occluded and cells without a slope; 254 for possible_drop and where any hazard reaches 1; else
/// 252 · (1 − Π(1 − h²)), rounded: 0 on ideal ground, growing with every hazard, never below the floors above.
std::uint8_t cell_cost(const GroundShape& ground, const VehicleConfig& vehicle);

}  // namespace scree::mapping
