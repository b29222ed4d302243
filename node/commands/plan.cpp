// scree plan: the example planner drives a robot to a goal over the map that a node sends.

#include <CLI/CLI.hpp>
#include <array>
#include <charconv>
#include <chrono>
#include <cstdint>
#include <fmt/format.h>
#include <memory>
#include <optional>
#include <spdlog/spdlog.h>
#include <string>

#include "client/examples/drive_command.hpp"
#include "client/examples/map_driver.hpp"
#include "drivers/terrain_load.hpp"
#include "node/commands/command_line.hpp"
#include "node/map_output.hpp"
#include "node/plan_report.hpp"
#include "node/progress.hpp"
#include "node/signals.hpp"

namespace scree::node {
namespace {

using scree_example::DriverConfig;
using scree_example::MapDriver;
using scree_example::Phase;

struct PlanOptions {
  std::string node = "127.0.0.1:47801";
  std::string bind = "127.0.0.1:0";
  std::string drive;
  std::string goal;
  std::string accept = "live";
  std::string unknown = "enter";
  std::uint32_t stream_id = 1;
  double speed_mps = 0.7;
  double cost_weight = 6.0;
  double limit_s = 300.0;
  double max_pose_age_s = 0.5;
  std::string terrain;
  std::optional<std::string> picture;
  std::optional<std::string> track;
  bool json = false;
};

/// "X,Y".
Result<scree_example::Point> parse_goal(const std::string& text) {
  scree_example::Point goal;
  const char* const end = text.data() + text.size();
  const auto x = std::from_chars(text.data(), end, goal.x_m);
  if (x.ec == std::errc{} && x.ptr != end && *x.ptr == ',') {
    const auto y = std::from_chars(x.ptr + 1, end, goal.y_m);
    if (y.ec == std::errc{} && y.ptr == end && std::abs(goal.x_m) < 1e6 && std::abs(goal.y_m) < 1e6) return goal;
  }
  return Error{ErrorKind::usage, "--goal: expected X,Y in metres of the map, found '" + text + "'"};
}

Result<std::uint8_t> parse_accept(const std::string& text) {
  using client::Origin;
  constexpr std::array<std::pair<const char*, Origin>, 4> kOrigins{
      {{"live", Origin::live}, {"replay", Origin::replay}, {"sim", Origin::sim}, {"hil", Origin::hil}}};
  unsigned accepted = 0;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    const std::string word = text.substr(begin, end - begin);
    const auto known = std::find_if(kOrigins.begin(), kOrigins.end(), [&](const auto& of) { return of.first == word; });
    if (known == kOrigins.end())
      return Error{ErrorKind::usage, "--accept: expected a list of live, replay, sim, hil, found '" + word + "'"};
    accepted |= client::origin_bit(known->second);
    begin = end + 1;
  }
  return static_cast<std::uint8_t>(accepted);
}

Result<DriverConfig> parse_config(const PlanOptions& options) {
  const auto goal = parse_goal(options.goal);
  if (!goal) return goal.error();
  const auto accept = parse_accept(options.accept);
  if (!accept) return accept.error();
  DriverConfig config;
  config.goal = *goal;
  config.map.bind = options.bind.c_str();
  config.map.node = options.node.c_str();
  config.map.stream_id = options.stream_id;
  config.map.layers = client::layer_bit(client::Layer::cost);
  config.map.accept_origins = *accept;
  config.map.log = [](void*, const char* text) { spdlog::warn("map: {}", text); };
  config.plan.cost_weight = options.cost_weight;
  config.plan.enter_unknown = options.unknown == "enter";
  config.follow.speed_mps = options.speed_mps;
  config.max_pose_age_s = options.max_pose_age_s;
  return config;
}

/// Until it arrived, gave up, ran out of time, or a signal.
Drive drive_to_goal(MapDriver& driver, scree_example::DriveSender& wheels, SignalWatch& signals,
                    const scree_example::Point& goal, double limit_s) {
  Drive drive;
  Progress progress("driving", 100);
  std::optional<double> first_m;
  const auto begin = MonotonicClock::now();
  for (;;) {
    driver.wait();
    wheels.send(driver.step());
    drive.duration_s = std::chrono::duration<double>(MonotonicClock::now() - begin).count();
    if (driver.phase() != Phase::waiting) {
      drive.note(drive.duration_s, driver.posture());
      const double left_m = scree_example::distance_m(driver.posture().at, goal);
      if (!first_m) first_m = left_m;
      progress.show(static_cast<std::size_t>(100.0 * std::clamp(1.0 - left_m / std::max(*first_m, 1e-6), 0.0, 1.0)));
    }
    if (driver.done()) drive.ended = driver.phase() == Phase::arrived ? "arrived" : "no_path";
    if (signals.wait(std::chrono::milliseconds(0))) drive.ended = "stopped";
    if (driver.done() || drive.ended == "stopped" || drive.duration_s >= limit_s) break;
  }
  for (int copy = 0; copy < 3; ++copy) wheels.send({});  // stand still, now
  return drive;
}

Status write_outputs(const PlanOptions& options, const Drive& drive, const MapDriver& driver,
                     const drivers::Terrain* terrain) {
  if (options.track) {
    if (auto written = write_track(*options.track, drive); !written) return written;
  }
  if (!options.picture) return {};
  if (auto written = write_plan_picture(*options.picture, drive, driver, terrain); !written) return written;
  spdlog::info("picture: {}", *options.picture);
  return {};
}

Result<int> run_plan(const PlanOptions& options) {
  const auto config = parse_config(options);
  if (!config) return config.error();
  if (options.picture) {  // a long drive must not end in a typing error
    if (const auto possible = check_picture_path("--picture", *options.picture); !possible) return possible.error();
  }
  std::optional<drivers::Terrain> terrain;
  if (!options.terrain.empty()) {
    auto loaded = drivers::load_terrain(options.terrain);
    if (!loaded) return loaded.error();
    terrain = *std::move(loaded);
  }
  SignalWatch signals;
  const auto driver = std::make_unique<MapDriver>();  // its receive buffers are no small thing for a stack
  if (!driver->open(*config)) return Error{ErrorKind::unavailable, fmt::format("scree plan: {}", driver->error())};
  scree_example::DriveSender wheels;
  if (!wheels.open(options.drive.c_str()))
    return Error{ErrorKind::usage, "--drive: expected a numeric ADDRESS:PORT, found '" + options.drive + "'"};
  const Drive drive = drive_to_goal(*driver, wheels, signals, config->goal, options.limit_s);
  signals.release();
  spdlog::info("{} after {:.1f} s and {:.1f} m, {:.2f} m from the goal", drive.ended, drive.duration_s, drive.path_m,
               scree_example::distance_m(driver->posture().at, config->goal));
  if (auto written = write_outputs(options, drive, *driver, terrain ? &*terrain : nullptr); !written)
    return written.error();
  if (options.json) {
    if (auto printed = print(plan_json(drive, *driver, wheels, config->goal)); !printed) return printed.error();
  }
  return drive.ended == "arrived" || drive.ended == "stopped" ? 0 : static_cast<int>(ErrorKind::unavailable);
}

}  // namespace

Command add_plan(CLI::App& app) {
  auto options = std::make_shared<PlanOptions>();
  CLI::App* command = app.add_subcommand("plan", "The example planner: drives a robot to a goal over the received map");
  command->add_option("--goal", options->goal, "Where to, in the map's metres")->required()->type_name("X,Y");
  command->add_option("--drive", options->drive, "Where drive commands go: `scree simulate --drive`")
      ->required()
      ->type_name("A:P");
  command->add_option("--node", options->node, "The node's publish.listen; default 127.0.0.1:47801")->type_name("A:P");
  command->add_option("--address", options->bind, "Where the map arrives; default any free port of the loopback")
      ->type_name("A:P");
  command->add_option("--stream", options->stream_id, "The node's publish.stream_id; default 1")->type_name("N");
  command->add_option("--accept", options->accept, "Origins it drives on; default live alone")->type_name("LIST");
  command->add_option("--unknown", options->unknown, "enter: unknown ground at a price, the default; avoid: never")
      ->check(CLI::IsMember({"enter", "avoid"}))
      ->type_name("enter|avoid");
  command->add_option("--cost-weight", options->cost_weight, "A metre over cost c counts 1 + W·c/252; default 6")
      ->check(CLI::Range(0.0, 1000.0))
      ->type_name("W");
  command->add_option("--speed", options->speed_mps, "m/s on straight ways; default 0.7")
      ->check(CLI::Range(0.05, 10.0))
      ->type_name("V");
  command->add_option("--max-pose-age", options->max_pose_age_s, "Stand still with an older pose; default 0.5")
      ->check(CLI::Range(0.05, 60.0))
      ->type_name("S");
  command->add_option("--limit", options->limit_s, "Give up after this long; default 300")
      ->check(CLI::Range(1.0, 1e6))
      ->type_name("S");
  command->add_option("--picture", options->picture, "The way over the costs, and over --terrain")->type_name("PNG");
  command->add_option("--terrain", options->terrain, "The true terrain, for the picture: as for scree simulate")
      ->type_name("FILE|fbm:...");
  command->add_option("--track", options->track, "Where the map said that the robot was")->type_name("CSV");
  command->add_flag("--json", options->json, "What was done and counted, on standard output");
  return {command, [options] { return run_plan(*options); }};
}

}  // namespace scree::node
