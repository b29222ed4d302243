#include "node/run_loop.hpp"

#include <chrono>
#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <utility>

#include "node/progress.hpp"
#include "node/service_notify.hpp"
#include "node/signals.hpp"

namespace scree::node {

namespace {

using std::chrono::milliseconds;

/// Feeds systemd's watchdog four times in its time, as long as no stage stands still for half of it.
class Watchdog {
 public:
  explicit Watchdog(const ServiceNotify& service) : service_(service) {}

  void look(const Pipeline& pipeline, MonotonicTime now) {
    const auto limit = service_.watchdog();
    if (!limit || now < next_) return;
    next_ = now + *limit / 4;
    const std::string stalled = pipeline.stalled(*limit / 2);
    if (stalled.empty()) {
      service_.feed_watchdog();
    } else if (stalled != said_) {
      spdlog::error("watchdog: {} has not advanced for {} ms: not fed", stalled,
                    std::chrono::duration_cast<milliseconds>(*limit / 2).count());
    }
    said_ = stalled;
  }

 private:
  const ServiceNotify& service_;
  MonotonicTime next_{};
  std::string said_;
};

/// How many frames there are to come, where that is known.
std::optional<std::size_t> frames_to_come(const std::vector<NodeSource>& sources) {
  if (sources.size() != 1 || sources[0].loop || sources[0].source == nullptr) return std::nullopt;
  return sources[0].source->frame_count();
}

}  // namespace

std::string names_of(const std::vector<NodeSource>& sources) {
  if (sources.size() == 1 && sources[0].source != nullptr) return sources[0].source->name();
  std::string names;
  for (const NodeSource& source : sources) names += (names.empty() ? "" : ", ") + source.name;
  return names;
}

Result<Outcome> run_to_end(PipelineConfig config, std::vector<NodeSource> sources, std::unique_ptr<Inbox> inbox,
                           std::unique_ptr<Publisher> publisher, std::unique_ptr<Recorder> recorder) {
  SignalWatch signals;
  const ServiceNotify service;
  Watchdog watchdog(service);
  const std::string name = names_of(sources);
  Progress progress("mapping", frames_to_come(sources).value_or(0));
  Pipeline pipeline(std::move(config), std::move(sources), std::move(inbox), std::move(publisher), std::move(recorder));
  service.ready("acquiring from " + name);
  Outcome outcome;
  auto next_line = MonotonicClock::now() + std::chrono::seconds(1);
  while (!pipeline.wait_finished(milliseconds(20))) {
    if (!outcome.interrupted && signals.wait(milliseconds(30))) {
      outcome.interrupted = true;
      signals.release();
      service.stopping();
      progress.clear();
      spdlog::info("stopping");
      pipeline.request_stop();
    }
    const auto now = MonotonicClock::now();
    watchdog.look(pipeline, now);
    if (now < next_line) continue;
    next_line += std::chrono::seconds(1);
    const Statistics statistics = pipeline.statistics();
    const std::string line = to_line(statistics);
    service.status(line);
    progress.clear();
    spdlog::info("{}", line);
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
