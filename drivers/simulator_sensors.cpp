#include "drivers/simulator_sensors.hpp"

#include <chrono>
#include <cmath>
#include <fmt/format.h>
#include <numbers>

namespace scree::drivers {
namespace {

using std::chrono::milliseconds;
constexpr double kDegree_rad = std::numbers::pi / 180.0;

/// Looking along the body's x axis, then pitched down. `level`: columns are the sensor's axes in the body.
Pose mounting(const Eigen::Matrix3d& level, double x_m, double z_m, double pitch_down_deg) {
  const Eigen::AngleAxisd pitch(pitch_down_deg * kDegree_rad, Eigen::Vector3d::UnitY());
  return {{x_m, 0.0, z_m}, (Eigen::Quaterniond(pitch) * Eigen::Quaterniond(level)).normalized()};
}

Eigen::Matrix3d axes(const Eigen::Vector3d& x, const Eigen::Vector3d& y, const Eigen::Vector3d& z) {
  Eigen::Matrix3d columns;
  columns << x, y, z;
  return columns;
}

// Body axes: x forward, y left, z up.
Eigen::Matrix3d perceptron_axes() {
  return axes(Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitZ(), Eigen::Vector3d::UnitX());
}
Eigen::Matrix3d pinhole_axes() {
  return axes(-Eigen::Vector3d::UnitY(), -Eigen::Vector3d::UnitZ(), Eigen::Vector3d::UnitX());
}

void set_rows(SimulatedSensor& simulated, int rows, int columns, Duration scan) {
  simulated.sensor.projection.rows = rows;
  simulated.sensor.projection.columns = columns;
  simulated.sensor.row_period = scan / rows;
}

/// 512 × 512 in half a second. 32° down from 1.6 m: level ground from 2.1 to 6.8 m, inside the first interval
/// (1.7 … 10 m). Noise of the size seen in published frames: some 2 mm at 2.5 m, 8 mm at 5 m of grazed ground.
SimulatedSensor perceptron_usf() {
  SimulatedSensor simulated;
  simulated.sensor.projection.kind = ProjectionKind::perceptron_usf;
  simulated.sensor.T_body_sensor = mounting(perceptron_axes(), 0.3, 1.6, 32.0);
  set_rows(simulated, 512, 512, milliseconds(500));
  simulated.frame_period = milliseconds(500);
  simulated.physics.shot_per_m = 5e-4;
  simulated.physics.thermal_per_m2 = 3e-5;
  simulated.physics.max_range_m = 20.0;
  simulated.physics.drift_m = 1e-3;
  simulated.sensor.filter.range_min_m = 0.5;
  return simulated;
}

/// 256 × 256, two frames a second, stronger beam. 35° down from 1.6 m: rows from 5° to 65° below the horizon.
SimulatedSensor perceptron_cmu() {
  SimulatedSensor simulated;
  simulated.sensor.projection.kind = ProjectionKind::perceptron_cmu;
  simulated.sensor.T_body_sensor = mounting(perceptron_axes(), 0.3, 1.6, 35.0);
  set_rows(simulated, 256, 256, milliseconds(500));
  simulated.frame_period = milliseconds(500);
  simulated.physics.shot_per_m = 5e-4;
  simulated.physics.thermal_per_m2 = 1e-5;
  simulated.physics.max_range_m = 60.0;
  simulated.physics.drift_m = 2e-3;
  simulated.sensor.filter.range_min_m = 0.5;
  return simulated;
}

/// 64 × 1024 over +2° … −24.8° all round. A real one turns, so that its columns, not its rows, differ in time; the
/// recording format knows rows only, hence the whole frame is taken at one instant.
SimulatedSensor lidar64() {
  constexpr int kRows = 64, kColumns = 1024;
  SimulatedSensor simulated;
  ProjectionConfig& projection = simulated.sensor.projection;
  projection.kind = ProjectionKind::spherical;
  projection.range_per_count_m = 0.002;
  for (int r = 0; r < kRows; ++r) projection.row_elevations_rad.push_back((2.0 - 26.8 * r / (kRows - 1)) * kDegree_rad);
  for (int c = 0; c < kColumns; ++c)
    projection.column_azimuths_rad.push_back(std::numbers::pi * (1.0 - (2.0 * c + 1.0) / kColumns));
  simulated.sensor.T_body_sensor = {{0.0, 0.0, 1.6}, Eigen::Quaterniond::Identity()};
  set_rows(simulated, kRows, kColumns, Duration{0});
  simulated.frame_period = milliseconds(100);
  simulated.physics.principle = RangePrinciple::pulse;
  simulated.physics.jitter_m = 0.015;
  simulated.physics.shot_per_m = 2e-4;
  simulated.physics.beam_pitches = 0.3;  // 2 mrad, narrower than the spacing of its beams
  simulated.physics.max_range_m = 120.0;
  simulated.sensor.filter.range_min_m = 0.9;
  return simulated;
}

/// Depth camera of 640 × 480 or, binned, fewer pixels with a global shutter, 30° down from 1 m. Noise as of structured
/// light, 1.4 mm/m².
SimulatedSensor depth_camera(int binning) {
  const int rows = 480 / binning, columns = 640 / binning;
  SimulatedSensor simulated;
  ProjectionConfig& projection = simulated.sensor.projection;
  projection.kind = ProjectionKind::pinhole;
  projection.fx_px = projection.fy_px = 525.0 / binning;
  projection.cx_px = 0.5 * (columns - 1);
  projection.cy_px = 0.5 * (rows - 1);
  projection.depth_unit_m = 0.001;
  simulated.sensor.T_body_sensor = mounting(pinhole_axes(), 0.2, 1.0, 30.0);
  set_rows(simulated, rows, columns, Duration{0});
  simulated.frame_period = milliseconds(100);
  simulated.physics.principle = RangePrinciple::stereo;
  simulated.physics.thermal_per_m2 = 1.4e-3;
  simulated.physics.max_range_m = 10.0;
  simulated.sensor.filter.range_min_m = 0.3;
  return simulated;
}

}  // namespace

Result<SimulatedSensor> simulated_sensor(std::string_view name) {
  SimulatedSensor simulated;
  if (name == "perceptron-usf")
    simulated = perceptron_usf();
  else if (name == "perceptron-cmu")
    simulated = perceptron_cmu();
  else if (name == "lidar64")
    simulated = lidar64();
  else if (name == "depth")
    simulated = depth_camera(1);
  else if (name == "depth-small")
    simulated = depth_camera(8);
  else
    return Error{ErrorKind::usage, fmt::format("expected {} for --sensor, found '{}'", kSimulatedSensors, name)};
  ProjectionConfig& projection = simulated.sensor.projection;
  projection.trusted_rows = projection.rows;
  projection.invalid_raw = 0;
  auto complete = complete_projection(projection, projection.rows, projection.columns);
  if (!complete) return complete.error();
  projection = *std::move(complete);
  simulated.sensor.filter.range_max_m = simulated.physics.max_range_m;
  return simulated;
}

RangeNoise declared_noise(const SensorConfig& sensor, const SensorPhysics& physics) {
  const double height_m = sensor.T_body_sensor.translation_m.z();
  const double spread = physics.reflectance * physics.reflectance_texture;
  const double constant = physics.jitter_m * physics.jitter_m + 0.5 * physics.drift_m * physics.drift_m;
  const bool needs_signal = physics.principle != RangePrinciple::stereo;
  /// Mean over the pixels of true / declared variance, when declared for reflectance · cos = s.
  const auto mean_ratio = [&](double s) {
    double sum = 0.0;
    int count = 0;
    for (int r = 0; r < sensor.projection.rows; r += 4)
      for (int c = 0; c < sensor.projection.columns; c += 16) {
        const double down = -(sensor.T_body_sensor.rotation * pixel_ray(sensor.projection, r, c).direction).z();
        const double range = height_m / down;
        if (!(down > 0.0 && range <= physics.max_range_m)) continue;
        for (const double reflectance : {physics.reflectance - 0.6 * spread, physics.reflectance + 0.6 * spread}) {
          const double sigma = nominal_sigma_m(physics, range, reflectance, down);
          const double drift = 0.5 * physics.drift_m * physics.drift_m;
          const double shot = physics.shot_per_m * range, thermal = physics.thermal_per_m2 * range * range / s;
          sum += (sigma * sigma + drift) / (constant + shot * shot / s + thermal * thermal);
          ++count;
        }
      }
    return count > 0 ? sum / count : s / (0.5 * physics.reflectance);  // sees no ground: incidence 60°
  };
  double low = 1e-6, high = 1.0;  // the ratio grows with s
  for (int i = 0; needs_signal && i < 40; ++i) {
    const double middle = std::sqrt(low * high);
    (mean_ratio(middle) < 1.0 ? low : high) = middle;
  }
  const double s = needs_signal ? high : 1.0;
  return {std::sqrt(constant), physics.shot_per_m / std::sqrt(s), physics.thermal_per_m2 / s};
}

}  // namespace scree::drivers
