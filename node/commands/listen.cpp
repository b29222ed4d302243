// scree listen: what a planner would see.

#include <CLI/CLI.hpp>
#include <chrono>
#include <fmt/format.h>
#include <memory>
#include <optional>
#include <set>
#include <spdlog/spdlog.h>
#include <sstream>
#include <string>
#include <utility>

#include "core/time.hpp"
#include "node/commands/command_line.hpp"
#include "node/listen_report.hpp"
#include "node/listener.hpp"
#include "node/map_output.hpp"
#include "node/signals.hpp"

namespace scree::node {
namespace {

struct ListenOptions {
  std::string address = "127.0.0.1:47800";
  std::string accept = "live,replay,sim,hil";
  std::optional<std::string> duration;
  OutputOptions output;
};

Result<std::set<drivers::Origin>> parse_origins(const std::string& text) {
  std::set<drivers::Origin> origins;
  std::istringstream words(text);
  for (std::string word; std::getline(words, word, ',');) {
    const auto origin = parse_origin(word);
    if (!origin)
      return Error{ErrorKind::usage, "--accept: expected a list of live, replay, sim, hil, found '" + word + "'"};
    origins.insert(*origin);
  }
  if (origins.empty()) return Error{ErrorKind::usage, "--accept: expected at least one origin, found none"};
  return origins;
}

Result<std::optional<Duration>> parse_duration(const std::optional<std::string>& text) {
  if (!text) return std::optional<Duration>();
  const auto parsed = parse_seconds(*text);
  if (parsed && parsed->count() >= 0) return std::optional(*parsed);
  return Error{ErrorKind::usage, "--duration: expected seconds of at least 0, found '" + *text + "'"};
}

/// Until BYE, the end of `duration`, or a signal. Says each change of the link once.
Status receive(Listener& listener, SignalWatch& signals, std::optional<Duration> duration) {
  const auto end = duration ? std::optional(MonotonicClock::now() + *duration) : std::nullopt;
  LinkState link = LinkState::waiting;
  while (!listener.ended() && !(end && MonotonicClock::now() >= *end)) {
    const auto received = listener.poll(std::chrono::milliseconds(20));
    if (!received) return received.error();
    if (listener.link() != link) {
      link = listener.link();
      spdlog::info("{}", describe_link(listener));
    }
    if (signals.wait(std::chrono::milliseconds(0))) break;
  }
  return {};
}

Status write_outputs(const ListenOptions& options, const std::optional<MapOutput>& map_output,
                     const Listener& listener) {
  const auto map = listener.last_valid_map();
  const std::string json = listen_json(listener, map.get());
  const Status printed = options.output.json ? print(json + '\n') : Status{};  // whether or not a map came
  spdlog::info("{}", listen_line(listener, map.get()));
  if (!map_output && !options.output.snapshot) return printed;
  if (map == nullptr)
    return Error{ErrorKind::bad_data, fmt::format("{}: expected a map, found {} datagrams without one", options.address,
                                                  listener.counters().datagrams)};
  if (map_output) {
    if (auto written = map_output->write(*map, json, announced_layers(listener)); !written) return written;
  }
  if (!options.output.snapshot) return printed;
  const auto source = fmt::format("{} received at {}", origin_name(listener.origin()), options.address);
  if (auto written = write_snapshot_picture(*options.output.snapshot, *map, source, RobotPlace::unknown); !written)
    return written;
  spdlog::info("picture: {}", *options.output.snapshot);
  return printed;
}

Result<int> run_listen(ListenOptions options) {
  auto origins = parse_origins(options.accept);
  if (!origins) return origins.error();
  const auto duration = parse_duration(options.duration);
  if (!duration) return duration.error();
  std::optional<MapOutput> map_output;
  if (options.output.map_out) {
    auto prepared = MapOutput::prepare(*options.output.map_out);
    if (!prepared) return prepared.error();
    map_output = *std::move(prepared);
  }
  if (options.output.snapshot) {
    if (const auto possible = check_picture_path("--snapshot", *options.output.snapshot); !possible)
      return possible.error();
  }

  SignalWatch signals;
  auto listener = Listener::open(options.address, *std::move(origins));
  if (!listener) return listener.error();
  options.address.replace(options.address.rfind(':') + 1, std::string::npos, std::to_string((*listener)->port()));
  spdlog::info("listening at {}", options.address);
  if (const auto received = receive(**listener, signals, *duration); !received) return received.error();
  signals.release();
  if (const auto written = write_outputs(options, map_output, **listener); !written) return written.error();
  return 0;
}

}  // namespace

Command add_listen(CLI::App& app) {
  auto options = std::make_shared<ListenOptions>();
  CLI::App* command = app.add_subcommand("listen", "A UDP client: receives the map as a planner would");
  command->add_option("--address", options->address, "Where datagrams arrive; default 127.0.0.1:47800")
      ->type_name("A:P");
  command->add_option("--accept", options->accept, "Origins taken; default all: live,replay,sim,hil")
      ->type_name("LIST");
  command->add_option("--duration", options->duration, "Stop after this long; else at BYE or SIGINT")->type_name("S");
  options->output.add_to(*command);
  return {command, [options] { return run_listen(*options); }};
}

}  // namespace scree::node
