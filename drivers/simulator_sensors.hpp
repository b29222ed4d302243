#pragma once
// The sensors that can be simulated by name.

#include <string>
#include <string_view>

#include "core/result.hpp"
#include "core/time.hpp"
#include "drivers/frame/sensor.hpp"
#include "drivers/simulator_physics.hpp"

namespace scree::drivers {

inline constexpr std::string_view kSimulatedSensors = "perceptron-usf | perceptron-cmu | lidar64 | depth | depth-small";

/// What a named sensor is: geometry, mounting, timing, physics.
struct SimulatedSensor {
  SensorConfig sensor;  ///< complete projection, trusted_rows = all, invalid_raw = 0; limits as the physics has them
  Duration frame_period{0};
  SensorPhysics physics;
};

/// Errors: usage (the name, with the names that there are).
Result<SimulatedSensor> simulated_sensor(std::string_view name);

/// The range noise to declare for `physics`: shot and thermal parts for that one reflectance · cos(incidence) for which
/// the declared variance is right on average over the sensor's view of level ground (each pixel the same weight).
RangeNoise declared_noise(const SensorConfig& sensor, const SensorPhysics& physics);

}  // namespace scree::drivers
