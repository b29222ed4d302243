#pragma once
// What a simulated sensor makes of the surfaces that its beam meets.

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace scree::drivers {

enum class RangePrinciple : std::uint8_t {
  phase,   ///< amplitude-modulated continuous wave: phasors of all surfaces in the beam add up (Perceptron)
  pulse,   ///< time of flight: the strongest echo counts (lidar)
  stereo,  ///< triangulation: a surface that fills most of the pixel, or nothing (depth camera)
};

/// With ρ the range in metres and s = reflectance · cos(incidence), the range noise has the standard deviation
/// sqrt(jitter_m² + (shot_per_m·ρ)²/s + (thermal_per_m2·ρ²/s)²); `stereo` has s = 1.
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
  double drift_m = 0.0;              ///< amplitude of the slow drift of the standoff (r0), a sine in time
  double drift_period_s = 60.0;
  /// Range error in metres at evenly spaced reflectances 0 … 1, interpolated; empty = none.
  std::vector<double> crosstalk_m;
};

/// A part of the beam that met a surface.
struct BeamEcho {
  double range_m = 0.0;
  double cos_incidence = 1.0;
  double reflectance = 0.5;
};

struct BeamReading {
  double range_m = 0.0;      ///< phase: within [0, ambiguity_m)
  double reflectance = 0.0;  ///< what the sensor takes it to be, at least 0
};

/// Standard deviation of the range of a surface filling the beam.
double nominal_sigma_m(const SensorPhysics& physics, double range_m, double reflectance, double cos_incidence);

/// The reading of a beam of `parts` equal parts, of which `echoes` met something within the physics' max_range_m or
/// beyond. `normals`: four independent standard normals. phase: arg of Σ (s/ρ²)·e^{iφ} plus complex noise, which turns
/// into a uniformly random range where the signal drowns; at edges anywhere between, or beyond, the surfaces. pulse:
/// mean range of the strongest chain of echoes with gaps below 0.3 m or 2 % of range. stereo: mean of the largest chain
/// with gaps below 5 % of range, if it fills half of the beam. Nothing: no reading (never for phase).
std::optional<BeamReading> read_beam(const SensorPhysics& physics, double ambiguity_m, std::span<const BeamEcho> echoes,
                                     int parts, const std::array<double, 4>& normals);

/// Reflectance of the ground: smooth noise on the world's lattice, a function of (seed, place) alone.
double ground_reflectance(const SensorPhysics& physics, std::uint64_t seed, double x_m, double y_m);

/// Offset of the ranges at a time.
double drift_offset_m(const SensorPhysics& physics, std::uint64_t seed, double t_s);

}  // namespace scree::drivers
