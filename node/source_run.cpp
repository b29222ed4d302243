#include "node/source_run.hpp"

#include <chrono>
#include <condition_variable>
#include <utility>

namespace scree::node {
namespace {

constexpr std::chrono::milliseconds kTimeout{100};       // of one question for a frame
constexpr std::chrono::milliseconds kBetweenTries{500};  // to open a source that failed

bool rest(const std::stop_token& stop) {
  std::mutex mutex;
  std::condition_variable_any never;
  std::unique_lock lock(mutex);
  never.wait_for(lock, stop, kBetweenTries, [] { return false; });
  return !stop.stop_requested();
}

}  // namespace

/// Marks the thread as inside its source.
class SourceRun::Inside {
 public:
  explicit Inside(SourceRun& run) : run_(run) { run_.inside_since_ = MonotonicClock::now().time_since_epoch().count(); }
  ~Inside() { run_.inside_since_ = 0; }
  Inside(const Inside&) = delete;
  Inside& operator=(const Inside&) = delete;

 private:
  SourceRun& run_;
};

SourceRun::SourceRun(const NodeSource& setup, std::unique_ptr<drivers::Source> source, std::size_t index,
                     SourceEvents& events)
    : index_(index),
      open_(setup.open),
      loop_(setup.loop),
      source_(std::move(source)),
      pacer_(setup.rate),
      events_(&events) {}

std::optional<MonotonicTime> SourceRun::inside_since() const {
  const Duration::rep since = inside_since_;
  if (since == 0) return std::nullopt;
  return MonotonicTime(Duration(since));
}

void SourceRun::abandon() {
  const std::lock_guard lock(gate_);
  events_ = nullptr;
}

void SourceRun::run(const std::stop_token& stop) {
  while (!stop.stop_requested() && turn(stop)) {
  }
  {
    const Inside closing(*this);
    source_.reset();
  }
  {
    const std::lock_guard lock(gate_);
    if (events_ != nullptr) events_->ended(index_);
  }
  returned_ = true;
}

/// False: nothing more will come.
bool SourceRun::turn(const std::stop_token& stop) {
  if (source_ == nullptr) return open_again(stop);
  auto event = [&] {
    const Inside waiting(*this);
    return source_->next(kTimeout);
  }();
  if (!event) {
    const bool again = fail(event.error());
    const Inside closing(*this);
    source_.reset();
    return again;
  }
  {
    const std::lock_guard lock(gate_);
    if (events_ == nullptr) return false;
    events_->counters(index_, source_->counters());
  }
  return take(*std::move(event), stop);
}

bool SourceRun::open_again(const std::stop_token& stop) {
  if (!open_ || !rest(stop)) return false;
  auto opened = [&] {
    const Inside opening(*this);
    return open_();
  }();
  if (!opened) return fail(opened.error());
  source_ = *std::move(opened);
  return true;
}

bool SourceRun::take(drivers::SourceEvent event, const std::stop_token& stop) {
  using Kind = drivers::SourceEvent::Kind;
  if (event.kind == Kind::end_of_stream) return begin_again();
  if (event.kind == Kind::frame && !pacer_.wait(event.frame->time, stop)) return false;
  const std::lock_guard lock(gate_);
  if (events_ == nullptr) return false;
  switch (event.kind) {
    case Kind::skipped:
      events_->skipped(index_, event.message);
      return true;
    case Kind::notice:
      events_->notice(index_, event.message);
      return true;
    case Kind::frame:
      if (!event.message.empty()) events_->notice(index_, "frame taken: " + event.message);
      return deliver(std::move(event.frame), stop);
    default:
      return true;
  }
}

/// Under the gate.
bool SourceRun::deliver(std::shared_ptr<const RangeFrame> frame, const std::stop_token& stop) {
  if (pacer_.paced()) {  // it is "received" when it is released, not when it was read from the file
    auto released = std::make_shared<RangeFrame>(*frame);
    released->received = MonotonicClock::now();
    frame = std::move(released);
  }
  ++frames_since_restart_;
  return events_->frame(index_, std::move(frame), source_->origin(), stop);
}

/// An empty stream is not begun again: it would never end.
bool SourceRun::begin_again() {
  if (!loop_ || !open_ || frames_since_restart_ == 0) return false;
  auto source = open_();
  if (!source) {
    source_.reset();
    return fail(source.error());
  }
  source_ = *std::move(source);
  pacer_.restart();
  frames_since_restart_ = 0;
  return true;
}

bool SourceRun::fail(const Error& error) {
  const std::lock_guard lock(gate_);
  return events_ != nullptr && events_->failed(index_, error);
}

}  // namespace scree::node
