// What the sources' threads tell the pipeline, and who looks after them.

#include <algorithm>
#include <chrono>
#include <spdlog/spdlog.h>
#include <thread>
#include <utility>

#include "node/pipeline.hpp"

namespace scree::node {
namespace {

constexpr std::uint64_t kSkippedShown = 10;
constexpr std::uint64_t kLateShown = 10;
constexpr std::chrono::milliseconds kRound{100};      // of the supervisor
constexpr std::chrono::milliseconds kLastWait{2000};  // for threads of sources to end, before they are left behind
/// So many threads that do not come back are no fault of one device.
constexpr std::size_t kMaxAbandoned = 16;

Time system_time() {
  return std::chrono::time_point_cast<Duration>(std::chrono::system_clock::now());
}

/// How far from ground that is under the robot now.
int unreality(drivers::Origin origin) {
  switch (origin) {
    case drivers::Origin::live:
      return 0;
    case drivers::Origin::hil:
      return 1;
    case drivers::Origin::sim:
      return 2;
    case drivers::Origin::replay:
      return 3;
  }
  return 3;
}

}  // namespace

bool Pipeline::frame(std::size_t source, std::shared_ptr<const RangeFrame> frame, drivers::Origin origin,
                     const std::stop_token& stop) {
  const Time now = system_time();
  const Time end = end_time(*frame);
  {
    const std::lock_guard lock(mutex_);
    SourceState& state = source_states_[source];
    ++statistics_.frames_in;
    ++state.statistics.frames_in;
    state.origin = origin;
    // told before the map that holds the frame is, and for good: the map keeps the ground
    if (!origin_ || unreality(origin) > unreality(*origin_)) origin_ = origin;
  }
  const auto pushed = queue_.push(std::move(frame), source, now, stop);
  if (pushed == FrameQueue::Pushed::late) note_late(source, now - end);
  if (pushed == FrameQueue::Pushed::taken) {
    const std::lock_guard lock(mutex_);
    source_states_[source].last_frame = MonotonicClock::now();
    source_states_[source].has_frame = true;
    source_states_[source].late_in_a_row = 0;
  }
  return pushed != FrameQueue::Pushed::stopped;
}

/// A source that is always late becomes stale and lost, as one that sends nothing does, but says why.
void Pipeline::note_late(std::size_t source, Duration age) {
  {
    const std::lock_guard lock(mutex_);
    if (++source_states_[source].late_in_a_row != kLateShown) return;
  }
  spdlog::error(
      "source {}: expected frames in the order of time, found {} in a row that end before what was mapped, the "
      "last {} ms ago: none is used (node.merge_ms; or its clock is wrong)",
      names_[source], kLateShown, std::chrono::duration_cast<std::chrono::milliseconds>(age).count());
}

void Pipeline::skipped(std::size_t source, const std::string& message) {
  std::uint64_t shown = 0;
  {
    const std::lock_guard lock(mutex_);
    ++statistics_.frames_skipped;
    shown = ++source_states_[source].statistics.frames_skipped;
  }
  if (shown <= kSkippedShown) spdlog::warn("frame skipped: {}", message);
  if (shown == kSkippedShown) spdlog::warn("further skipped frames are only counted");
}

void Pipeline::notice(std::size_t, const std::string& message) {
  spdlog::warn("{}", message);
}

void Pipeline::counters(std::size_t source, const drivers::SourceCounters& counters) {
  const std::lock_guard lock(mutex_);
  source_states_[source].statistics.counters = counters;
}

/// One source that fails ends the node; of several it is opened again while the others go on.
bool Pipeline::failed(std::size_t source, const Error& error) {
  if (!live() || source_states_.size() == 1) {
    fail(error, false);
    return false;
  }
  std::uint64_t failures = 0;
  {
    const std::lock_guard lock(mutex_);
    failures = ++source_states_[source].statistics.failures;
  }
  if (failures <= kSkippedShown) spdlog::error("source {}: {}; trying again", names_[source], error.message);
  if (failures == kSkippedShown) spdlog::error("source {}: further failures are only counted", names_[source]);
  return true;
}

void Pipeline::ended(std::size_t source) {
  const std::lock_guard lock(mutex_);
  source_states_[source].ended = true;
  if (std::all_of(source_states_.begin(), source_states_.end(), [](const auto& state) { return state.ended; }))
    queue_.close();
}

// ---- supervise ----

void Pipeline::supervise(const std::stop_token& stop) {
  std::mutex mutex;
  std::condition_variable_any never;
  while (!stop.stop_requested()) {
    supervise_beat_.touch();
    {
      const std::lock_guard lock(sources_mutex_);
      for (std::size_t i = 0; i < sources_.size(); ++i) look_after(i);
      bury_abandoned();
    }
    std::unique_lock lock(mutex);
    never.wait_for(lock, stop, kRound, [] { return false; });
  }
  supervise_beat_.rest();
}

/// Under sources_mutex_. A source that neither delivers nor fails: its thread is left where it is, and another one
/// opens the source again.
void Pipeline::look_after(std::size_t index) {
  Acquired& acquired = sources_[index];
  const auto since = acquired.run->inside_since();
  acquired.rounds = since && since == acquired.inside_since ? acquired.rounds + 1 : 0;
  acquired.inside_since = since;
  if (!acquired.setup.deadline || !acquired.setup.open || stop_.stop_requested()) return;
  // as seen round by round, not by the clock: a process that was stopped for a while is no driver that hangs
  if (acquired.rounds * kRound < *acquired.setup.deadline) return;
  if (abandoned_.size() >= kMaxAbandoned) return give_up(acquired.setup.name);
  spdlog::error("source {}: expected its driver to return within {} ms, it did not: it is left behind and opened again",
                acquired.setup.name,
                std::chrono::duration_cast<std::chrono::milliseconds>(*acquired.setup.deadline).count());
  acquired.run->abandon();
  acquired.thread.request_stop();
  acquired.rounds = 0;
  abandoned_.push_back(std::move(acquired));
  acquired.setup = {abandoned_.back().setup.name, nullptr,
                    abandoned_.back().setup.open, abandoned_.back().setup.loop,
                    abandoned_.back().setup.rate, abandoned_.back().setup.deadline};
  {
    const std::lock_guard lock(mutex_);
    ++source_states_[index].statistics.abandoned;
  }
  start_source(index, nullptr);
}

/// Under sources_mutex_. FAULT, for good: only a new process is rid of threads that do not come back.
void Pipeline::give_up(const std::string& source) {
  const std::lock_guard lock(mutex_);
  faulty_ = true;
  if (std::exchange(gave_up_, true)) return;
  spdlog::error("source {}: {} threads are left behind already: it is not opened again", source, kMaxAbandoned);
}

/// Under sources_mutex_.
void Pipeline::bury_abandoned() {
  std::erase_if(abandoned_, [](const Acquired& acquired) { return acquired.run->returned(); });  // joins
}

/// A thread that does not come back must not keep the process: what it uses is its own.
void Pipeline::end_sources() {
  const std::lock_guard lock(sources_mutex_);
  std::move(abandoned_.begin(), abandoned_.end(), std::back_inserter(sources_));
  abandoned_.clear();
  const auto limit = MonotonicClock::now() + kLastWait;
  for (Acquired& acquired : sources_) {
    while (live() && !acquired.run->returned() && MonotonicClock::now() < limit)
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    if (!live() || acquired.run->returned()) continue;  // its jthread joins
    acquired.run->abandon();
    acquired.thread.detach();
    spdlog::error("source {}: its driver did not return, its thread is left behind", acquired.setup.name);
  }
  sources_.clear();
}

std::string Pipeline::stalled(Duration limit) const {
  const auto now = MonotonicClock::now();
  if (supervise_beat_.age(now) > limit) return "acquire";
  {
    const std::lock_guard lock(mutex_);
    if (gave_up_) return "acquire";
  }
  const auto waiting = queue_.waiting_since();
  if (map_beat_.age(now) > limit || (waiting && now - *waiting > limit)) return "map";
  if (publish_beat_.age(now) > limit) return "publish";
  if (receive_beat_.age(now) > limit) return "receive";
  return {};
}

}  // namespace scree::node
