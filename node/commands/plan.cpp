// scree plan: the example planner drives a robot to a goal over the map that a node sends.

#include <CLI/CLI.hpp>
#include <array>
#include <charconv>
#include <chrono>
#include <cstdint>
#include <fmt/format.h>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <spdlog/spdlog.h>
#include <string>
#include <vector>

#include "client/examples/drive_command.hpp"
#include "client/examples/map_driver.hpp"
#include "drivers/terrain_load.hpp"
#include "io/picture.hpp"
#include "node/commands/command_line.hpp"
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
  return config;
}

struct TrackPoint {
  double t_s, x_m, y_m, heading_rad;
};

/// What the planner did, and when it ended.
struct Drive {
  std::vector<TrackPoint> track;  ///< where the map said that the robot was, whenever it had moved by 2 cm
  double path_m = 0.0, duration_s = 0.0;
  std::string ended = "timeout";

  void note(double t_s, const scree_example::Posture& posture) {
    if (!track.empty()) {
      const TrackPoint& last = track.back();
      const double moved_m = std::hypot(posture.at.x_m - last.x_m, posture.at.y_m - last.y_m);
      if (moved_m < 0.02) return;
      path_m += moved_m;
    }
    track.push_back({t_s, posture.at.x_m, posture.at.y_m, posture.heading_rad});
  }
};

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

std::string plan_json(const Drive& drive, const MapDriver& driver, const scree_example::DriveSender& wheels,
                      const scree_example::Point& goal) {
  const auto& counters = driver.counters();
  nlohmann::ordered_json json{{"ended", drive.ended},
                              {"duration_s", drive.duration_s},
                              {"path_m", drive.path_m},
                              {"distance_to_goal_m", scree_example::distance_m(driver.posture().at, goal)},
                              {"plans", counters.plans},
                              {"plans_without_path", counters.plans_without_path},
                              {"stops_not_fresh", counters.stops_not_fresh},
                              {"commands_sent", wheels.sent()},
                              {"commands_failed", wheels.failed()}};
  auto& received = json["received"] = nlohmann::ordered_json::object();
  driver.map().counters().for_each([&](const char* name, std::uint64_t value) { received[name] = value; });
  return json.dump(2) + '\n';
}

Status write_track(const std::string& file, const Drive& drive) {
  std::ofstream stream(file, std::ios::binary);
  stream << "t_s,x_m,y_m,heading_rad\n";
  for (const TrackPoint& p : drive.track)
    stream << fmt::format("{:.3f},{:.4f},{:.4f},{:.5f}\n", p.t_s, p.x_m, p.y_m, p.heading_rad);
  stream.close();
  if (stream) return {};
  return Error{ErrorKind::cannot_create, fmt::format("{}: expected a file that can be written, found none", file)};
}

/// The way over the true terrain, and over the costs that the last plan saw.
Status write_picture(const std::string& file, const Drive& drive, const MapDriver& driver,
                     const drivers::Terrain* terrain) {
  const auto& grid = driver.grid();
  if (grid.cost.empty()) return Error{ErrorKind::bad_data, file + ": expected a map to draw, found none received"};
  Grid<float> cost(grid.rows, grid.columns), height_m(grid.rows, grid.columns, std::nanf(""));
  for (int row = 0; row < grid.rows; ++row)
    for (int column = 0; column < grid.columns; ++column) {
      const std::size_t i = grid.index(column, row);
      cost(row, column) = grid.cost[i] == scree_example::kUnknown ? std::nanf("") : static_cast<float>(grid.cost[i]);
      const auto at = grid.centre(i);
      if (terrain != nullptr) height_m(row, column) = static_cast<float>(terrain->height_m(at.x_m, at.y_m));
    }
  std::vector<io::PicturePanel> panels;
  if (terrain != nullptr)
    panels.push_back({"true terrain / m", height_m, {io::ColourMap::terrain, std::nullopt, std::nullopt, true}});
  panels.push_back({"cost at the last plan (0 free, 254 lethal)", cost, {io::ColourMap::cost, 0.0, 254.0, false}});
  io::PicturePath way;
  for (const TrackPoint& p : drive.track) way.points_m.push_back({p.x_m, p.y_m});
  return io::write_map_picture(file, panels, {grid.x_min_m, grid.y_min_m, grid.cell_m}, std::nullopt,
                               fmt::format("{} after {:.1f} s, {:.1f} m", drive.ended, drive.duration_s, drive.path_m),
                               {way});
}

Status write_outputs(const PlanOptions& options, const Drive& drive, const MapDriver& driver,
                     const drivers::Terrain* terrain) {
  if (options.track) {
    if (auto written = write_track(*options.track, drive); !written) return written;
  }
  if (!options.picture) return {};
  if (auto written = write_picture(*options.picture, drive, driver, terrain); !written) return written;
  spdlog::info("picture: {}", *options.picture);
  return {};
}

Result<int> run_plan(const PlanOptions& options) {
  const auto config = parse_config(options);
  if (!config) return config.error();
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
