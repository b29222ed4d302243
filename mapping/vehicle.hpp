#pragma once

namespace scree::mapping {

/// The vehicle whose costs are published ("vehicle.*" of the configuration). SI units.
struct VehicleConfig {
  double track_m = 0.5;
  double wheelbase_m = 0.6;
  double wheel_radius_m = 0.15;
  double clearance_m = 0.15;
  double max_pitch_rad = 0.45;
  double max_roll_rad = 0.35;
  double max_step_m = 0.12;
  double height_m = 1.0;  ///< what hangs at least this much above the ground does not touch the vehicle
};

}  // namespace scree::mapping
