// scree run: the live node; the newest frame wins.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <memory>
#include <optional>
#include <spdlog/spdlog.h>
#include <string>
#include <utility>
#include <vector>

#include "node/commands/command_line.hpp"
#include "node/commands/run_node.hpp"
#include "node/node_source.hpp"

namespace scree::node {
namespace {

struct RunOptions {
  ConfigOptions config;
  OutputOptions output;
  std::optional<std::string> record;
};

/// What the datagrams say before the first frame: a simulated device and a recording say it themselves, whatever the
/// configuration claims.
drivers::Origin origin_of(const config::Settings& settings) {
  const auto sources = settings.all_sources();
  const auto has = [&](config::SourceKind kind) {
    return std::any_of(sources.begin(), sources.end(), [&](const auto& source) { return source.kind == kind; });
  };
  if (has(config::SourceKind::recording)) return drivers::Origin::replay;
  return has(config::SourceKind::simulated) ? drivers::Origin::sim : settings.publish.origin;
}

/// How long a call into the source may take: beyond its own deadline, a second of a machine that is slow, or the 5 s of
/// a kernel that waits for an answer of a USB device. What only computes or reads files may take as long as it needs.
std::optional<Duration> patience(const config::SourceSettings& source) {
  const std::chrono::milliseconds deadline(source.deadline_ms);
  switch (source.kind) {
    case config::SourceKind::stream:
      return deadline + std::chrono::seconds(1);
    case config::SourceKind::usb:
    case config::SourceKind::v4l2:
      return deadline + std::chrono::seconds(8);
    default:
      return std::nullopt;
  }
}

bool is_recording(const config::SourceSettings& source) {
  return source.kind == config::SourceKind::recording;
}

/// Of several sources one that can not be opened yet is tried again while the others go on; what is wrong with the
/// configuration is said at once.
Result<std::vector<NodeSource>> open_all(const config::Settings& settings) {
  std::vector<NodeSource> sources;
  const auto all = settings.all_sources();
  for (const config::SourceSettings& source : all) {
    OpenSource open = [source, settings] { return open_live(source, settings); };
    auto opened = open();
    const std::string name = source.name_at(sources.size());
    if (!opened && (all.size() == 1 || opened.error().kind == ErrorKind::bad_config)) return opened.error();
    if (!opened) spdlog::error("source {}: {}; trying again", name, opened.error().message);
    const auto rate = is_recording(source) ? std::optional(1.0) : std::nullopt;
    sources.push_back(
        {name, opened ? *std::move(opened) : nullptr, std::move(open), source.loop, rate, patience(source)});
  }
  return sources;
}

Result<int> run_live(const RunOptions& options) {
  auto settings = options.config.load();
  if (!settings) return settings.error();
  const auto all = settings->all_sources();
  if (options.record && std::any_of(all.begin(), all.end(), is_recording))
    return Error{ErrorKind::usage, "--record: expected live sources, found one of kind recording"};
  NodeRun run;
  run.origin = origin_of(*settings);
  run.pipeline.played = std::all_of(all.begin(), all.end(), is_recording);
  run.pipeline.policy = QueuePolicy::newest_wins;
  run.output = options.output;
  run.record = options.record;
  run.pipeline.settings = *settings;
  return run_node(std::move(run), [settings = *std::move(settings)] { return open_all(settings); });
}

}  // namespace

Command add_run(CLI::App& app) {
  auto options = std::make_shared<RunOptions>();
  CLI::App* command = app.add_subcommand("run", "The live node: acquire, map, publish until stopped");
  options->config.add_to(*command);
  command->get_option("--config")->required();
  options->output.add_to(*command);
  command
      ->add_option("--record", options->record,
                   "Record what is mapped into this new or empty directory; `scree replay` gives the same map")
      ->type_name("DIR");
  return {command, [options] { return run_live(*options); }};
}

}  // namespace scree::node
