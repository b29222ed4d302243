#include "node/run_loop.hpp"

#include <chrono>
#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <utility>

#include "node/progress.hpp"
#include "node/signals.hpp"

namespace scree::node {

Result<Outcome> run_to_end(PipelineConfig config, std::unique_ptr<drivers::Source> source, std::unique_ptr<Inbox> inbox,
                           std::unique_ptr<Publisher> publisher) {
  using std::chrono::milliseconds;
  SignalWatch signals;
  const std::string name = source->name();
  const auto frames = config.reopen ? std::nullopt : source->frame_count();
  Progress progress("mapping", frames.value_or(0));
  Pipeline pipeline(std::move(config), std::move(source), std::move(inbox), std::move(publisher));
  Outcome outcome;
  auto next_line = MonotonicClock::now() + std::chrono::seconds(1);
  while (!pipeline.wait_finished(milliseconds(20))) {
    if (!outcome.interrupted && signals.wait(milliseconds(30))) {
      outcome.interrupted = true;
      signals.release();
      progress.clear();
      spdlog::info("stopping");
      pipeline.request_stop();
    }
    if (MonotonicClock::now() < next_line) continue;
    next_line += std::chrono::seconds(1);
    const Statistics statistics = pipeline.statistics();
    progress.clear();
    spdlog::info("{}", to_line(statistics));
    progress.show(statistics.frames_mapped + statistics.frames_skipped + statistics.frames_pose_stale);
  }
  progress.clear();
  outcome.statistics = pipeline.statistics();
  outcome.map = pipeline.map();
  outcome.publish_error = pipeline.publish_error();
  spdlog::info("{}", to_line(outcome.statistics));
  if (const auto error = pipeline.error()) return *error;
  if (outcome.map == nullptr && !outcome.interrupted)
    return Error{
        ErrorKind::bad_data,
        fmt::format("{}: expected at least one frame that can be mapped, found {} bad and {} without a fresh pose",
                    name, outcome.statistics.frames_skipped, outcome.statistics.frames_pose_stale)};
  return outcome;
}

}  // namespace scree::node
