// A served device before and after its drive: what it opens, and what it says of itself.

#include <cmath>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <utility>

#include "node/random_id.hpp"
#include "node/served_device_state.hpp"

namespace scree::node {
namespace {

/// Perceptron words have their reflectance beside the range, as the scanner has.
drivers::stream::Geometry geometry_of(const drivers::Simulator& simulator, const std::string& sensor) {
  drivers::stream::Geometry geometry{simulator.description().sensor, 2, "simulated " + sensor};
  if (is_perceptron(geometry.sensor.projection.kind)) {
    geometry.word_bytes = 4;
    geometry.sensor.projection.reflectance_shift = 16;
  }
  return geometry;
}

/// Of GEOMETRY and FRAME together, with as many poses as can lie around the rows.
std::size_t largest_message(const drivers::stream::Geometry& geometry, const drivers::stream::Encoder& encoder) {
  const auto rows = static_cast<std::size_t>(geometry.sensor.projection.rows);
  const auto columns = static_cast<std::size_t>(geometry.sensor.projection.columns);
  const std::size_t poses = geometry.sensor.row_period == Duration{0} ? 2 : drivers::stream::kMaxPoses;
  return 2 * drivers::stream::kHeaderBytes + encoder.geometry_payload().size() + drivers::stream::kFrameBytes +
         8 * rows + drivers::stream::kPoseBytes * poses +
         static_cast<std::size_t>(geometry.word_bytes) * rows * columns;
}

/// Words of 16 bits are what a depth image holds.
drivers::ServedShape shape_of(const drivers::Simulator& simulator, const drivers::stream::Geometry& geometry,
                              const drivers::stream::Encoder& encoder) {
  const ProjectionConfig& projection = geometry.sensor.projection;
  return {geometry.device,
          projection.rows,
          projection.columns,
          geometry.word_bytes == 2,
          simulator.frame_time(1) - simulator.frame_time(0),
          largest_message(geometry, encoder)};
}

/// The same device, were its images half as high.
drivers::stream::Geometry upper_half(drivers::stream::Geometry geometry) {
  ProjectionConfig& projection = geometry.sensor.projection;
  projection.rows /= 2;
  projection.trusted_rows = projection.rows;
  if (!projection.row_elevations_rad.empty())
    projection.row_elevations_rad.resize(static_cast<std::size_t>(projection.rows));
  return geometry;
}

nlohmann::ordered_json faults_json(const FaultInjector& faults) {
  nlohmann::ordered_json json;
  for (std::size_t i = 0; i < drivers::kFaultKinds; ++i)
    json[std::string(to_string(static_cast<drivers::FaultKind>(i)))] = faults.injected()[i];
  json["frames_corrupted"] = faults.frames_corrupted();
  json["frames_of_wrong_geometry"] = faults.frames_of_wrong_geometry();
  return json;
}

}  // namespace

Status ServedDevice::State::open_drive() {
  if (!options.drive) {
    way = along_trajectory(simulator);
    return {};
  }
  const StampedPose& start = simulator.poses().poses().front();
  const Eigen::Vector3d forward = start.T_map_body.rotation * Eigen::Vector3d::UnitX();
  const drivers::PlanarPose place{start.time, start.T_map_body.translation_m.x(), start.T_map_body.translation_m.y(),
                                  std::atan2(forward.y(), forward.x())};
  drivers::TrajectoryConfig placing;
  placing.placement = simulator.config().placement;
  auto made = drivers::DrivenRobot::make(simulator.terrain(), place, placing, simulator.config().odometry,
                                         simulator.config().seed);
  if (!made) return made.error();
  robot = *std::move(made);
  way = as_driven(simulator, *robot);
  const auto endpoint = parse_endpoint(*options.drive, "--drive");
  if (!endpoint) return endpoint.error();
  auto socket = UdpSocket::bind(*endpoint, "--drive");
  if (!socket) return socket.error();
  drive_socket = *std::move(socket);
  drive_host = options.drive->substr(0, options.drive->rfind(':'));
  return {};
}

Status ServedDevice::State::open_faults(const drivers::stream::Geometry& geometry) {
  if (!options.faults) return {};
  auto script = drivers::load_fault_script(*options.faults);
  if (!script) return script.error();
  for (const drivers::Fault& fault : *script)
    if (drivers::needs_endpoint(fault.kind) && !server->has_endpoints())
      return Error{ErrorKind::usage,
                   fmt::format("{}:{}: expected faults of a socket, found '{}', which needs --serve usbredir:",
                               *options.faults, fault.line, to_string(fault.kind))};
  faults.emplace(*std::move(script), simulator.frame_time(1) - simulator.frame_time(0),
                 drivers::stream::encode_geometry(upper_half(geometry)));
  return {};
}

Status ServedDevice::State::open_outputs(std::uint64_t boot_id) {
  for (const std::string& destination : options.pose_out) {
    auto output = PoseOutput::open(destination, options.stream_id, boot_id);
    if (!output) return output.error();
    pose_outputs.push_back(*std::move(output));
  }
  if (!options.track) return {};
  track.open(*options.track, std::ios::binary | std::ios::trunc);
  track << drivers::kPosesHeader << '\n';
  if (track) return {};
  return Error{ErrorKind::cannot_create, *options.track + ": expected a file that can be written, found none"};
}

Result<std::unique_ptr<ServedDevice>> ServedDevice::open(drivers::Simulator simulator, const std::string& sensor,
                                                         ServeOptions options) {
  const auto boot_id = random_id("boot_id");
  if (!boot_id) return boot_id.error();
  const drivers::stream::Geometry geometry = geometry_of(simulator, sensor);
  auto encoder = drivers::stream::Encoder::make(geometry, *boot_id, true);
  if (!encoder) return encoder.error();
  const drivers::ServedShape shape = shape_of(simulator, geometry, *encoder);
  auto server = drivers::open_frame_server(options.address, shape);
  if (!server) return server.error();
  auto state =
      std::make_unique<State>(std::move(simulator), std::move(options), *std::move(server), *std::move(encoder));
  state->sensor = sensor;
  state->has_images = shape.camera;
  if (auto opened = state->open_faults(geometry); !opened) return opened.error();
  if (auto opened = state->open_drive(); !opened) return opened.error();
  if (auto opened = state->open_outputs(*boot_id); !opened) return opened.error();
  return std::unique_ptr<ServedDevice>(new ServedDevice(std::move(state)));
}

std::string ServedDevice::report() const {
  const State& s = *state_;
  const auto& counters = s.server->counters();
  std::uint64_t poses_sent = 0, poses_failed = 0;
  for (const PoseOutput& output : s.pose_outputs) {
    poses_sent += output.sent();
    poses_failed += output.failed();
  }
  const LimitsMet& met = s.ground.met();
  const auto& vehicle = s.options.vehicle;
  nlohmann::ordered_json json{{"duration_s", to_seconds(s.now() - s.simulator.frame_time(0))},
                              {"frames_rendered", s.rendered},
                              {"frames_late", s.late},
                              {"frames_unread", s.unread},
                              {"frames_sent", counters.sent},
                              {"frames_superseded", counters.superseded},
                              {"frames_broken_off", counters.broken},
                              {"readers", counters.readers},
                              {"readers_refused", counters.readers_refused},
                              {"poses_sent", poses_sent},
                              {"poses_failed", poses_failed},
                              {"path_m", s.ground.path_m()},
                              {"violated_m", s.ground.violated_m()},
                              {"pitch_max_rad", met.pitch_rad},
                              {"roll_max_rad", met.roll_rad},
                              {"step_max_m", met.step_m},
                              {"belly_max_m", met.belly_m},
                              {"limits",
                               {{"max_pitch_rad", vehicle.max_pitch_rad},
                                {"max_roll_rad", vehicle.max_roll_rad},
                                {"max_step_m", vehicle.max_step_m},
                                {"clearance_m", vehicle.clearance_m}}},
                              {"poses_judged", s.ground.judged()},
                              {"poses_without_ground", s.ground.without_ground()}};
  if (s.robot)
    json["drive"] = {{"commands", s.commands.accepted()},
                     {"rejected", s.commands.rejected()},
                     {"timeouts", s.robot->timeouts()},
                     {"edge_stops", s.robot->edge_stops()}};
  if (s.faults) json["faults"] = faults_json(*s.faults);
  return json.dump(2);
}

}  // namespace scree::node
