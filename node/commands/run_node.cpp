#include "node/commands/run_node.hpp"

#include <cstdint>
#include <optional>
#include <spdlog/spdlog.h>
#include <string>
#include <utility>
#include <vector>

#include "config/loader.hpp"
#include "node/listen_report.hpp"
#include "node/map_output.hpp"
#include "node/protocol_header.hpp"
#include "node/recorder.hpp"
#include "node/run_loop.hpp"

namespace scree::node {
namespace {

Status write_outputs(const OutputOptions& options, const std::optional<MapOutput>& map_output, const Outcome& outcome,
                     const std::string& source) {
  const std::string json = to_json(outcome.statistics);
  if (outcome.map != nullptr && map_output) {
    if (auto written = map_output->write(*outcome.map, json); !written) return written;
  }
  if (outcome.map != nullptr && options.snapshot) {
    if (auto written = write_snapshot_picture(*options.snapshot, *outcome.map, source, RobotPlace::known); !written)
      return written;
    spdlog::info("picture: {}", *options.snapshot);
  }
  return options.json ? print(json + '\n') : Status{};
}

/// Null without --record.
Result<std::unique_ptr<Recorder>> open_recorder(const NodeRun& run, const std::vector<NodeSource>& sources) {
  if (!run.record) return std::unique_ptr<Recorder>();
  std::vector<std::string> names;
  for (const NodeSource& source : sources) names.push_back(source.name);
  auto recorder = Recorder::open(*run.record, run.pipeline.settings.record, names);
  if (recorder) spdlog::info("recording into {}", *run.record);
  return recorder;
}

}  // namespace

Result<int> run_node(NodeRun run, const OpenSources& open) {
  std::optional<MapOutput> map_output;
  if (run.output.map_out) {
    auto prepared = MapOutput::prepare(*run.output.map_out);
    if (!prepared) return prepared.error();
    map_output = *std::move(prepared);
  }
  if (run.output.snapshot) {
    if (const auto possible = check_picture_path("--snapshot", *run.output.snapshot); !possible)
      return possible.error();
  }
  auto sources = open();
  if (!sources) return sources.error();
  if (run.pipeline.settings.pose.source == config::PoseSource::udp && run.pipeline.policy == QueuePolicy::lossless &&
      !sources->front().rate)
    return Error{ErrorKind::usage, "--rate max: expected a pace with pose.source udp, whose poses come in real time"};

  const config::Settings& settings = run.pipeline.settings;
  const std::uint32_t hash = protocol::config_hash(config::dump_settings(settings));
  const auto keys = make_key_ring(settings.publish.keys);
  if (!keys) return keys.error();
  auto inbox = Inbox::open(settings.publish.listen, settings.pose.accept_from, settings.publish.stream_id, *keys);
  if (!inbox) return inbox.error();
  auto publisher = Publisher::open(settings.publish, run.origin, settings.map.cell_m, hash, (*inbox)->socket());
  if (!publisher) return publisher.error();
  const std::string listen_address = settings.publish.listen.substr(0, settings.publish.listen.find(':'));
  spdlog::info("listening at {}:{}", listen_address, (*inbox)->port());

  auto recorder = open_recorder(run, *sources);
  if (!recorder) return recorder.error();
  const std::string name = names_of(*sources);
  spdlog::info("{} → {} as {}, configuration {:08x}", name, settings.publish.destination, origin_name(run.origin),
               hash);
  auto outcome = run_to_end(std::move(run.pipeline), *std::move(sources), *std::move(inbox), *std::move(publisher),
                            *std::move(recorder));
  if (!outcome) return outcome.error();
  const std::string caption = std::string(origin_name(run.origin)) + "   " + name;
  if (auto written = write_outputs(run.output, map_output, *outcome, caption); !written) return written.error();
  if (outcome->publish_error) return *outcome->publish_error;
  return 0;
}

}  // namespace scree::node
