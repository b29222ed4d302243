// scree simulate: the simulated scanner writes a recording, or acts as a live device.

#include <CLI/CLI.hpp>
#include <cstddef>
#include <filesystem>
#include <fmt/format.h>
#include <memory>
#include <numbers>
#include <optional>
#include <spdlog/spdlog.h>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "config/loader.hpp"
#include "config/recording_file.hpp"
#include "drivers/simulator.hpp"
#include "node/commands/command_line.hpp"
#include "node/progress.hpp"
#include "node/served_device.hpp"

namespace scree::node {
namespace {

struct SimulateOptions {
  drivers::SimulatorConfig simulator;
  std::string noise = "nominal";
  double attitude_error_deg = 0.0;
  double frame_period_s = 0.0;
  std::optional<std::string> out;
  ServeOptions serve;
  double duration_s = 0.0;
  std::uint64_t frames = 0;
  std::optional<std::string> config;
  std::vector<std::string> assignments;
  bool json = false;
};

/// Rendering takes a while: an output that cannot be made is said before.
Status check_directory(const std::filesystem::path& directory) {
  std::error_code status;
  std::filesystem::create_directories(directory, status);
  if (!status && std::filesystem::is_directory(directory)) return {};
  return Error{ErrorKind::cannot_create, fmt::format("{}: expected a directory that can be created, found: {}",
                                                     directory.string(), status ? status.message() : "something else")};
}

Result<int> write_recording(const SimulateOptions& options, const std::string& out) {
  const auto simulator = drivers::Simulator::make(options.simulator);
  if (!simulator) return simulator.error();
  if (const auto possible = check_directory(out); !possible) return possible.error();
  const std::string yaml = config::write_recording(simulator->description());
  SerialExecutor executor;
  Progress progress("rendering", simulator->frame_count());
  const auto written = drivers::write_recording(*simulator, out, yaml, executor,
                                                [&](std::size_t done, std::size_t) { progress.show(done); });
  progress.clear();
  if (!written) return written.error();
  spdlog::info("{}: {} frames of {}", out, simulator->frame_count(), options.simulator.sensor);
  return 0;
}

Result<int> serve_device(const SimulateOptions& options) {
  const auto settings = config::load_settings(options.config, options.assignments);
  if (!settings) return settings.error();
  ServeOptions serve = options.serve;
  serve.vehicle = settings->map.vehicle;
  serve.stream_id = settings->publish.stream_id;
  if (options.duration_s > 0.0) serve.duration = from_seconds(options.duration_s);
  if (options.frames > 0) serve.frames = options.frames;
  auto simulator = drivers::Simulator::make(options.simulator);
  if (!simulator) return simulator.error();
  auto device = ServedDevice::open(*std::move(simulator), options.simulator.sensor, std::move(serve));
  if (!device) return device.error();
  if (const auto ran = (*device)->run(); !ran) return ran.error();
  const std::string report = (*device)->report();
  if (options.json) {
    if (const auto printed = print(report + '\n'); !printed) return printed.error();
  }
  return 0;
}

/// What belongs to a device makes no sense beside a recording, and the other way round.
Status check_mode(const SimulateOptions& options) {
  if (options.out.has_value() == !options.serve.address.empty())
    return Error{ErrorKind::usage, fmt::format("simulate: expected one of --out and --serve, found {}",
                                               options.out ? "both" : "neither")};
  const ServeOptions& serve = options.serve;
  const bool of_a_device = serve.drive || serve.faults || !serve.pose_out.empty() || serve.track ||
                           options.duration_s > 0.0 || options.frames > 0 || options.config ||
                           !options.assignments.empty() || options.json;
  if (options.out && of_a_device)
    return Error{ErrorKind::usage, "simulate: expected --serve with the options of a device, found --out"};
  return {};
}

Result<int> run_simulate(SimulateOptions options) {
  if (const auto possible = check_mode(options); !possible) return possible.error();
  options.simulator.noise = options.noise == "nominal";
  options.simulator.odometry.attitude_rms_rad = options.attitude_error_deg * std::numbers::pi / 180.0;
  options.simulator.frame_period = from_seconds(options.frame_period_s);
  return options.out ? write_recording(options, *options.out) : serve_device(options);
}

void add_device_options(CLI::App& command, SimulateOptions& options) {
  ServeOptions& serve = options.serve;
  command.add_option("--serve", serve.address, "Act as a live device instead: source.kind stream connects here")
      ->type_name("unix:PATH|tcp:PORT|usbredir:PATH");
  command
      .add_option("--drive", serve.drive,
                  "The robot starts where the trajectory does and obeys drive commands (UDP) that come here")
      ->type_name("ADDRESS:PORT");
  command.add_option("--faults", serve.faults, "Script of what goes wrong with the device (docs/simulator.md)")
      ->type_name("FILE");
  command.add_option("--pose-out", serve.pose_out, "POSE_INPUT messages of the odometry go here; repeatable")
      ->type_name("ADDRESS:PORT")
      ->allow_extra_args(false);
  command.add_option("--track", serve.track, "File for the true poses, as poses.csv")->type_name("FILE.csv");
  command.add_option("--duration", options.duration_s, "End the drive after this time")
      ->check(CLI::PositiveNumber)
      ->type_name("S");
  command.add_option("--frames", options.frames, "End the drive after this many frames")
      ->check(CLI::PositiveNumber)
      ->type_name("N");
  command.add_option("--config", options.config, "Configuration whose vehicle.* the way is judged by")
      ->type_name("FILE");
  command.add_option("--set", options.assignments, "Override one key of it; repeatable")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  command.add_flag("--json", options.json, "Print the report of the drive as one JSON document");
}

}  // namespace

Command add_simulate(CLI::App& app) {
  auto options = std::make_shared<SimulateOptions>();
  auto& simulator = options->simulator;
  CLI::App* command = app.add_subcommand("simulate", "The simulated scanner writes a recording, or is a live device");
  command
      ->add_option("--terrain", simulator.terrain,
                   "A DEM or point file, or fbm:D,AMPLITUDE_M,SEED[,EXTENT_M=60[,CELL_M=0.05]]")
      ->required()
      ->type_name("FILE|fbm:...");
  command->add_option("--sensor", simulator.sensor, "perceptron-usf, perceptron-cmu, lidar64, depth or depth-small")
      ->required()
      ->check(CLI::IsMember({"perceptron-usf", "perceptron-cmu", "lidar64", "depth", "depth-small"}))
      ->type_name("NAME");
  command
      ->add_option("--trajectory", simulator.trajectory,
                   "A CSV file, line:X0,Y0,HEADING_DEG,LENGTH_M,SPEED_MPS or "
                   "arc:X0,Y0,HEADING_DEG,RADIUS_M,ANGLE_DEG,SPEED_MPS")
      ->required()
      ->type_name("FILE|line:...|arc:...");
  command->add_option("--noise", options->noise, "off: exact to quantisation; default nominal")
      ->check(CLI::IsMember({"off", "nominal"}))
      ->type_name("off|nominal");
  command
      ->add_option("--odometry-drift", simulator.odometry.drift_share,
                   "poses.csv errs by this share of the way (rms), in each direction; truth/poses.csv does not")
      ->check(CLI::Range(0.0, 1.0))
      ->type_name("SHARE");
  command
      ->add_option("--attitude-error-deg", options->attitude_error_deg,
                   "poses.csv errs by this angle (rms) about each axis, slowly varying")
      ->check(CLI::Range(0.0, 25.0))
      ->type_name("DEG");
  add_seed(*command, [options](std::uint64_t seed) { options->simulator.seed = seed; });
  command
      ->add_option("--frame-period", options->frame_period_s, "Seconds from frame to frame; default the sensor's own")
      ->check(CLI::Range(0.0, 3600.0))
      ->type_name("S");
  command->add_option("--out", options->out, "Directory of the recording")->type_name("DIR");
  add_device_options(*command, *options);
  return {command, [options] { return run_simulate(*options); }};
}

}  // namespace scree::node
