#pragma once
// What a served device holds; see served_device.hpp.

#include <fstream>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "drivers/drive_command.hpp"
#include "drivers/frame_server.hpp"
#include "drivers/frame_stream.hpp"
#include "drivers/table.hpp"
#include "node/fault_injector.hpp"
#include "node/ground_limits.hpp"
#include "node/pose_output.hpp"
#include "node/robot_way.hpp"
#include "node/served_device.hpp"
#include "node/signals.hpp"
#include "node/udp_socket.hpp"

namespace scree::node {

struct ServedDevice::State {
  State(drivers::Simulator the_simulator, ServeOptions the_options, std::unique_ptr<drivers::FrameServer> the_server,
        drivers::stream::Encoder the_encoder)
      : simulator(std::move(the_simulator)),
        options(std::move(the_options)),
        server(std::move(the_server)),
        encoder(std::move(the_encoder)),
        ground(simulator.terrain(), options.vehicle) {}

  Status open_drive();
  Status open_faults(const drivers::stream::Geometry& geometry);
  Status open_outputs(std::uint64_t boot_id);
  Time now() const;  ///< of the drive
  void begin();
  void serve();
  void take_commands();
  void inject_faults();
  void note_poses();
  bool stopped();
  bool serve_until(const std::function<bool()>& reached);
  void drain();
  Status render_and_send(std::size_t i);

  SignalWatch signals;
  drivers::Simulator simulator;
  ServeOptions options;
  std::string sensor;
  bool has_images = false;  ///< counts go out as images too
  std::unique_ptr<drivers::FrameServer> server;
  drivers::stream::Encoder encoder;
  GroundLimits ground;
  std::optional<drivers::DrivenRobot> robot;
  std::unique_ptr<RobotWay> way;
  std::optional<UdpSocket> drive_socket;
  std::string drive_host;
  drivers::DriveReceiver commands;
  std::vector<PoseOutput> pose_outputs;
  std::ofstream track;
  std::optional<FaultInjector> faults;
  std::optional<MonotonicTime> first_reader;

  std::optional<MonotonicTime> began;
  Duration epoch{0};         ///< Unix time of the drive's zero
  Time noted = Time::min();  ///< of the last pose that was noted
  Time next_pose_out = Time::min();
  bool interrupted = false;
  std::optional<Error> error;
  std::uint64_t rendered = 0, late = 0, unread = 0;
};

}  // namespace scree::node
