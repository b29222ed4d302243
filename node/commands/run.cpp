// scree run: the live node; the newest frame wins.

#include <CLI/CLI.hpp>
#include <memory>
#include <utility>

#include "node/commands/command_line.hpp"
#include "node/commands/run_node.hpp"
#include "node/node_source.hpp"

namespace scree::node {
namespace {

struct RunOptions {
  ConfigOptions config;
  OutputOptions output;
};

/// What the datagrams say: a simulated device and a recording say it themselves, whatever the configuration claims.
drivers::Origin origin_of(const config::Settings& settings) {
  if (settings.source.kind == config::SourceKind::recording) return drivers::Origin::replay;
  if (settings.source.kind == config::SourceKind::simulated) return drivers::Origin::sim;
  return settings.publish.origin;
}

Result<int> run_live(const RunOptions& options) {
  auto settings = options.config.load();
  if (!settings) return settings.error();
  const auto open = [settings = *settings] { return open_live(settings); };
  NodeRun run;
  run.origin = origin_of(*settings);
  if (settings->source.kind == config::SourceKind::recording) run.pipeline.rate = 1.0;
  if (settings->source.loop) run.pipeline.reopen = open;
  run.pipeline.policy = QueuePolicy::newest_wins;
  run.pipeline.settings = *std::move(settings);
  run.output = options.output;
  return run_node(std::move(run), open);
}

}  // namespace

Command add_run(CLI::App& app) {
  auto options = std::make_shared<RunOptions>();
  CLI::App* command = app.add_subcommand("run", "The live node: acquire, map, publish until stopped");
  options->config.add_to(*command);
  command->get_option("--config")->required();
  options->output.add_to(*command);
  return {command, [options] { return run_live(*options); }};
}

}  // namespace scree::node
