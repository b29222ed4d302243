#pragma once
// What a simulated sensor makes of the surfaces that its beam meets.

#include <cstdint>
#include <vector>

namespace scree::drivers {

enum class RangePrinciple : std::uint8_t {
  phase,   ///< amplitude-modulated continuous wave: phasors of all surfaces in the beam add up (Perceptron)
  pulse,   ///< time of flight: the strongest echo counts (lidar)
  stereo,  ///< triangulation: the largest surface in the pixel counts, noise on its depth (depth camera)
};

/// With ρ the range in metres and s = reflectance · cos(incidence), the range noise has the standard deviation
/// sqrt(jitter_m² + (shot_per_m·ρ)²/s + (thermal_per_m2·ρ²/s)²); `stereo` ignores s.
struct SensorPhysics {
  RangePrinciple principle = RangePrinciple::phase;
  double jitter_m = 0.0;
  double shot_per_m = 0.0;
  double thermal_per_m2 = 0.0;
  double reflectance = 0.5;          ///< mean of the ground
  double reflectance_texture = 0.3;  ///< the ground's reflectance varies by ± this share of the mean
  double texture_m = 0.4;            ///< over this distance
  double beam_pitches = 1.0;         ///< width of the beam in pixel pitches
  double max_range_m = 20.0;         ///< beyond: no detectable return
  double drift_m = 0.0;              ///< amplitude of the slow drift of the standoff (r0)
  double drift_period_s = 60.0;
  /// Range error in metres at evenly spaced reflectances 0 … 1, interpolated; empty = none.
  std::vector<double> crosstalk_m;
};

/// Standard deviation of the range of a surface filling the beam.
double nominal_sigma_m(const SensorPhysics& physics, double range_m, double reflectance, double cos_incidence);

}  // namespace scree::drivers
