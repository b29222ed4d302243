// scree simulate: the simulated scanner writes a recording.

#include <CLI/CLI.hpp>
#include <cstddef>
#include <filesystem>
#include <fmt/format.h>
#include <memory>
#include <numbers>
#include <spdlog/spdlog.h>
#include <string>
#include <system_error>

#include "config/recording_file.hpp"
#include "drivers/simulator.hpp"
#include "node/commands/command_line.hpp"
#include "node/progress.hpp"

namespace scree::node {
namespace {

struct SimulateOptions {
  drivers::SimulatorConfig simulator;
  std::string noise = "nominal";
  double attitude_error_deg = 0.0;
  std::string out;
};

/// Rendering takes a while: an output that cannot be made is said before.
Status check_directory(const std::filesystem::path& directory) {
  std::error_code status;
  std::filesystem::create_directories(directory, status);
  if (!status && std::filesystem::is_directory(directory)) return {};
  return Error{ErrorKind::cannot_create, fmt::format("{}: expected a directory that can be created, found: {}",
                                                     directory.string(), status ? status.message() : "something else")};
}

Result<int> run_simulate(SimulateOptions options) {
  options.simulator.noise = options.noise == "nominal";
  options.simulator.odometry.attitude_rms_rad = options.attitude_error_deg * std::numbers::pi / 180.0;
  const auto simulator = drivers::Simulator::make(options.simulator);
  if (!simulator) return simulator.error();
  if (const auto possible = check_directory(options.out); !possible) return possible.error();
  const std::string yaml = config::write_recording(simulator->description());
  SerialExecutor executor;
  Progress progress("rendering", simulator->frame_count());
  const auto written = drivers::write_recording(*simulator, options.out, yaml, executor,
                                                [&](std::size_t done, std::size_t) { progress.show(done); });
  progress.clear();
  if (!written) return written.error();
  spdlog::info("{}: {} frames of {}", options.out, simulator->frame_count(), options.simulator.sensor);
  return 0;
}

}  // namespace

Command add_simulate(CLI::App& app) {
  auto options = std::make_shared<SimulateOptions>();
  auto& simulator = options->simulator;
  CLI::App* command = app.add_subcommand("simulate", "The simulated scanner writes a recording, with truth beside it");
  command
      ->add_option("--terrain", simulator.terrain,
                   "A DEM or point file, or fbm:D,AMPLITUDE_M,SEED[,EXTENT_M=60[,CELL_M=0.05]]")
      ->required()
      ->type_name("FILE|fbm:...");
  command->add_option("--sensor", simulator.sensor, "perceptron-usf, perceptron-cmu, lidar64 or depth")
      ->required()
      ->check(CLI::IsMember({"perceptron-usf", "perceptron-cmu", "lidar64", "depth"}))
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
  command->add_option("--out", options->out, "Directory of the recording")->required()->type_name("DIR");
  return {command, [options] { return run_simulate(*options); }};
}

}  // namespace scree::node
