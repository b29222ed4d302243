#pragma once
// One frame of rays against the terrain: the inner loops of the simulator.

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/executor.hpp"
#include "core/grid.hpp"
#include "core/pose.hpp"
#include "drivers/frame/projection.hpp"
#include "drivers/simulator_physics.hpp"
#include "drivers/terrain.hpp"

namespace scree::drivers {

/// What one frame of a simulated sensor needs to know; referenced objects outlive the call.
struct ScanSetup {
  const Terrain& terrain;
  const SensorPhysics& physics;
  const std::vector<PixelRay>& rays;  ///< rows × columns, sensor axes
  int rows = 0;
  int columns = 0;
  double ambiguity_m = 0.0;  ///< 0 = none
  bool noise = true;
  std::uint64_t seed = 1;
};

struct ScanResult {
  Grid<std::uint16_t> raw;
  Grid<float> true_range_m;
  Grid<std::uint16_t> reflectance;
};

/// `T_map_sensor` and `drift_m`: one per row. `sequence` keys the random numbers. Casts the central ray of every pixel;
/// with noise, where ranges bend or break within the 3 × 3 neighbourhood, nine rays over the beam. Deterministic for
/// any executor. Cost: about 0.5 µs a ray.
ScanResult scan(const ScanSetup& setup, const std::vector<Pose>& T_map_sensor, const std::vector<double>& drift_m,
                std::uint64_t sequence, Executor& executor);

/// The count that the sensor records for a range along the ray, never 0 (that means "met nothing"): phase sensors wrap,
/// and what rounds to 0 becomes 1 or 4095, whichever is nearer; others give 0 beyond their scale.
std::uint16_t record_count(const PixelRay& ray, double range_m, bool wraps);

}  // namespace scree::drivers
