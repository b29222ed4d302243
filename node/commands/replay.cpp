// scree replay: the node on a recording, lossless.

#include <CLI/CLI.hpp>
#include <charconv>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "core/time.hpp"
#include "node/commands/command_line.hpp"
#include "node/commands/run_node.hpp"
#include "node/node_source.hpp"

namespace scree::node {
namespace {

struct ReplayOptions {
  std::string recording;
  std::string format = "auto";
  std::string rate = "1";
  std::string start = "0";
  std::optional<std::string> duration;
  bool loop = false;
  ConfigOptions config;
  OutputOptions output;
};

Result<std::optional<double>> parse_rate(const std::string& text) {
  if (text == "max") return std::optional<double>();
  double rate = 0.0;
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), rate);
  if (status == std::errc() && end == text.data() + text.size() && std::isfinite(rate) && rate >= 1e-3)
    return std::optional(rate);
  return Error{ErrorKind::usage, "--rate: expected a number of at least 0.001, or max, found '" + text + "'"};
}

Result<Duration> parse_span(const std::string& option, const std::string& text) {
  const auto span = parse_seconds(text);
  if (span && span->count() >= 0) return *span;
  return Error{ErrorKind::usage, option + ": expected seconds of at least 0, found '" + text + "'"};
}

Result<drivers::ReplayWindow> parse_window(const ReplayOptions& options) {
  const auto start = parse_span("--start", options.start);
  if (!start) return start.error();
  drivers::ReplayWindow window{*start, std::nullopt};
  if (!options.duration) return window;
  if (options.loop)
    return Error{ErrorKind::usage, "--duration: expected no --loop beside it (a loop has no end), found both"};
  const auto duration = parse_span("--duration", *options.duration);
  if (!duration) return duration.error();
  window.duration = *duration;
  return window;
}

Result<int> run_replay(const ReplayOptions& options) {
  const auto rate = parse_rate(options.rate);
  if (!rate) return rate.error();
  const auto window = parse_window(options);
  if (!window) return window.error();
  auto settings = options.config.load();
  if (!settings) return settings.error();
  const OpenSource open = [options, window = *window, settings = *settings] {
    return open_input(options.recording, options.format, window, settings);
  };
  const auto open_one = [&]() -> Result<std::vector<NodeSource>> {
    auto source = open();
    if (!source) return source.error();
    std::vector<NodeSource> one;
    one.push_back({options.recording, *std::move(source), open, options.loop, *rate, std::nullopt});
    return one;
  };
  NodeRun run;
  run.pipeline.settings = *std::move(settings);
  run.pipeline.policy = QueuePolicy::lossless;
  run.pipeline.played = rate->has_value();
  run.origin = drivers::Origin::replay;
  run.output = options.output;
  return run_node(std::move(run), open_one);
}

}  // namespace

Command add_replay(CLI::App& app) {
  auto options = std::make_shared<ReplayOptions>();
  CLI::App* command = app.add_subcommand("replay", "The node on a recording: nothing dropped, same map every time");
  command->add_option("RECORDING", options->recording, "Recording directory or a single range file")->required();
  command->add_option("--format", options->format, "Of a directory that is not a recording of Scree: kitti, pcd")
      ->check(CLI::IsMember({"auto", "kitti", "pcd"}))
      ->type_name("FORMAT");
  command->add_option("--rate", options->rate, "Times real time, or max; default 1")->type_name("R|max");
  command->add_flag("--loop", options->loop, "Begin again at the end");
  command->add_option("--start", options->start, "Skip this much at the beginning")->type_name("S");
  command->add_option("--duration", options->duration, "Stop after this much data time")->type_name("S");
  options->config.add_to(*command);
  options->output.add_to(*command);
  return {command, [options] { return run_replay(*options); }};
}

}  // namespace scree::node
