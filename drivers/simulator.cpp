#include "drivers/simulator.hpp"

#include <fmt/format.h>
#include <limits>
#include <utility>
#include <vector>

#include "drivers/simulator_scan.hpp"

namespace scree::drivers {

struct Simulator::State {
  SimulatorConfig config;
  SimulatedSensor simulated;
  RecordingDescription description;
  Terrain terrain;
  Trajectory trajectory;
  PoseTrack odometry;
  std::shared_ptr<const Projection> projection;
  std::shared_ptr<const SensorConfig> sensor;
  std::vector<PixelRay> rays;
  std::size_t frame_count = 0;

  SimulatedFrame render(const PoseTrack& track, Time frame_begin, std::size_t i, Executor& executor) const;
  int rows() const { return projection->rows; }
  Time row_time(Time frame_time, int row) const { return frame_time + row * sensor->row_period; }
  /// Frames begin during the drive and end before the hold does.
  static Pose body_at(const PoseTrack& track, Time time) {
    return track.at(time).value_or(track.poses().back().T_map_body);
  }
};

namespace {

Result<SimulatedSensor> configured_sensor(const SimulatorConfig& config) {
  auto simulated = simulated_sensor(config.sensor);
  if (!simulated) return simulated.error();
  if (config.frame_period < Duration{0})
    return Error{ErrorKind::usage,
                 fmt::format("expected a positive frame period, found {} s", format_seconds(config.frame_period))};
  if (config.frame_period > Duration{0}) simulated->frame_period = config.frame_period;
  const Duration scan = simulated->sensor.row_period * simulated->sensor.projection.rows;
  if (simulated->frame_period < scan)
    return Error{ErrorKind::usage,
                 fmt::format("expected a frame period of at least the scan of {} ({} s), found {} s", config.sensor,
                             format_seconds(scan), format_seconds(config.frame_period))};
  const OdometryErrors& errors = config.odometry;
  if (!(errors.drift_share >= 0.0 && errors.drift_share <= 1.0 && errors.attitude_rms_rad >= 0.0 &&
        errors.attitude_rms_rad <= 0.5))
    return Error{ErrorKind::usage,
                 fmt::format("expected an odometry drift of 0 … 1 of the way and an attitude error of "
                             "0 … 0.5 rad, found {} and {} rad",
                             errors.drift_share, errors.attitude_rms_rad)};
  if (config.T_body_sensor) simulated->sensor.T_body_sensor = *config.T_body_sensor;
  if (config.physics) {
    simulated->physics = *config.physics;
    simulated->sensor.filter.range_max_m = config.physics->max_range_m;
  }
  simulated->sensor.noise =
      config.noise ? declared_noise(simulated->sensor, simulated->physics) : RangeNoise{0.0, 0.0, 0.0};
  return simulated;
}

std::vector<PixelRay> tabulate_rays(const ProjectionConfig& projection) {
  std::vector<PixelRay> rays;
  rays.reserve(static_cast<std::size_t>(projection.rows) * static_cast<std::size_t>(projection.columns));
  for (int r = 0; r < projection.rows; ++r)
    for (int c = 0; c < projection.columns; ++c) rays.push_back(pixel_ray(projection, r, c));
  return rays;
}

}  // namespace

Result<Simulator> Simulator::make(const SimulatorConfig& config) {
  auto simulated = configured_sensor(config);
  if (!simulated) return simulated.error();
  const SensorConfig& sensor = simulated->sensor;
  auto projection = make_projection(sensor.projection, sensor.projection.rows, sensor.projection.columns);
  if (!projection) return projection.error();
  // The grammar first: it is checked at once, while a terrain may take seconds.
  if (const auto way = planar_way(config.trajectory, std::chrono::milliseconds(10)); !way) return way.error();
  auto terrain = load_terrain(config.terrain, config.gridding);
  if (!terrain) return terrain.error();
  TrajectoryConfig way;
  way.placement = config.placement;
  way.hold = sensor.row_period * sensor.projection.rows;
  auto trajectory = make_trajectory(config.trajectory, *terrain, way);
  if (!trajectory) return trajectory.error();

  const auto frames = static_cast<std::size_t>(trajectory->drive / simulated->frame_period) + 1;
  auto shared_sensor = std::make_shared<const SensorConfig>(sensor);
  auto rays = tabulate_rays(sensor.projection);
  auto odometry = odometry_track(trajectory->track, config.odometry, config.seed);
  RecordingDescription description{Origin::sim, sensor};
  return Simulator(std::make_unique<State>(
      State{config, *std::move(simulated), std::move(description), *std::move(terrain), *std::move(trajectory),
            std::move(odometry), *std::move(projection), std::move(shared_sensor), std::move(rays), frames}));
}

Simulator::Simulator(std::unique_ptr<State> state) : state_(std::move(state)) {}
Simulator::Simulator(Simulator&&) noexcept = default;
Simulator& Simulator::operator=(Simulator&&) noexcept = default;
Simulator::~Simulator() = default;

const RecordingDescription& Simulator::description() const {
  return state_->description;
}
const SimulatorConfig& Simulator::config() const {
  return state_->config;
}
std::size_t Simulator::frame_count() const {
  return state_->frame_count;
}
const Terrain& Simulator::terrain() const {
  return state_->terrain;
}
const PoseTrack& Simulator::poses() const {
  return state_->trajectory.track;
}
const PoseTrack& Simulator::odometry() const {
  return state_->odometry;
}
Time Simulator::frame_time(std::size_t i) const {
  return state_->trajectory.track.begin() + static_cast<std::int64_t>(i) * state_->simulated.frame_period;
}

Time Simulator::last_row_time(std::size_t i) const {
  return state_->row_time(frame_time(i), state_->rows() - 1);
}

Result<SimulatedFrame> Simulator::render(std::size_t i, Executor& executor) const {
  if (i >= state_->frame_count)
    return Error{ErrorKind::usage,
                 fmt::format("simulator: expected a frame below {}, found {}", state_->frame_count, i)};
  return state_->render(state_->trajectory.track, frame_time(i), i, executor);
}

Result<SimulatedFrame> Simulator::render_along(const PoseTrack& track, std::size_t i, Executor& executor) const {
  if (!track.at(frame_time(i)) || !track.at(last_row_time(i)))
    return Error{ErrorKind::usage, fmt::format("simulator: expected poses for the rows of frame {}, found none", i)};
  return state_->render(track, frame_time(i), i, executor);
}

SimulatedFrame Simulator::State::render(const PoseTrack& track, Time frame_begin, std::size_t i,
                                        Executor& executor) const {
  const State& s = *this;
  SimulatedFrame frame;
  frame.sequence = i;
  frame.time = frame_begin;
  std::vector<Pose> T_map_sensor;
  std::vector<double> drift_m;
  for (int row = 0; row < s.rows(); ++row) {
    const Time time = s.row_time(frame.time, row);
    T_map_sensor.push_back(s.body_at(track, time) * s.sensor->T_body_sensor);
    drift_m.push_back(drift_offset_m(s.simulated.physics, s.config.seed, to_seconds(time.time_since_epoch())));
  }
  const ScanSetup setup{s.terrain,      s.simulated.physics,   s.rays,
                        s.rows(),       s.projection->columns, s.projection->ambiguity_m,
                        s.config.noise, s.config.seed};
  ScanResult result = scan(setup, T_map_sensor, drift_m, i, executor);
  frame.raw = std::move(result.raw);
  frame.true_range_m = std::move(result.true_range_m);
  frame.reflectance = std::move(result.reflectance);
  return frame;
}

std::shared_ptr<const RangeFrame> Simulator::range_frame(const SimulatedFrame& frame, Duration epoch) const {
  const State& s = *state_;
  auto out = std::make_shared<RangeFrame>();
  out->projection = s.projection;
  out->sensor = s.sensor;
  out->sequence = frame.sequence;
  out->time = frame.time + epoch;
  out->received = MonotonicClock::now();
  out->range_m.assign(s.rows(), s.projection->columns, std::numeric_limits<float>::quiet_NaN());
  for (std::size_t i = 0; i < frame.raw.size(); ++i)
    if (frame.raw[i] != 0)
      out->range_m[i] =
          s.projection->range_offset_m[i] + static_cast<float>(frame.raw[i]) * s.projection->range_per_count_m[i];
  out->raw = frame.raw;
  out->reflectance = frame.reflectance;
  for (int row = 0; row < s.rows(); ++row) {
    out->row_time.push_back(s.row_time(out->time, row));
    out->T_map_body.push_back(s.body_at(s.odometry, s.row_time(frame.time, row)));
  }
  return out;
}

}  // namespace scree::drivers
