#include "node/frame_queue.hpp"

#include <algorithm>
#include <utility>

namespace scree::node {
namespace {

/// A source that was silent for this long, and for two of its own intervals, holds nobody back.
constexpr Duration kDelivering = std::chrono::seconds(1);
/// What threads that are scheduled late add to a frame's way.
constexpr Duration kMargin = std::chrono::milliseconds(5);
/// Of the largest lateness, a frame: half is forgotten after some 35 frames.
constexpr double kKept = 0.98;

}  // namespace

Time end_time(const RangeFrame& frame) {
  return frame.row_time.empty() ? frame.time : frame.row_time.back();
}

FrameQueue::Pushed FrameQueue::push(std::shared_ptr<const RangeFrame> frame, std::size_t source, Time now,
                                    const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  Lane& lane = lanes_[source];
  const std::size_t capacity = merges() ? kHeld : config_.capacity;
  if (config_.policy == QueuePolicy::lossless) {
    if (!changed_.wait(lock, stop, [&] { return lane.frames.size() < capacity; })) return Pushed::stopped;
  } else {
    while (lane.frames.size() >= capacity) {
      lane.frames.pop_front();
      ++lane.losses.dropped;
    }
  }
  const Time end = std::min(end_time(*frame), now);  // a clock that runs ahead must not make everybody else late
  const Duration age = std::clamp(now - end, Duration(0), config_.merge);
  const auto remembered = static_cast<double>(lane.lateness.count()) * kKept;
  const auto arrival = MonotonicClock::now();
  lane.lateness = std::max(age, Duration(static_cast<Duration::rep>(remembered)));
  if (lane.last_arrival) lane.interval = arrival - *lane.last_arrival;
  lane.last_arrival = arrival;
  if (given_ && *given_ > now) given_.reset();  // the clock was set back
  if (merges() && given_ && end < *given_) {
    ++lane.losses.late;
    return Pushed::late;
  }
  lane.frames.push_back({std::move(frame), end, arrival, age});
  if (!waiting_since_) waiting_since_ = arrival;
  changed_.notify_all();
  return Pushed::taken;
}

std::optional<std::size_t> FrameQueue::earliest() const {
  std::optional<std::size_t> best;
  for (std::size_t i = 0; i < lanes_.size(); ++i)
    if (!lanes_[i].frames.empty() && (!best || lanes_[i].frames.front().end < lanes_[*best].frames.front().end))
      best = i;
  return best;
}

/// When nobody else can be expected to bring an earlier frame than this one of `source`.
MonotonicTime FrameQueue::due(std::size_t source, const Waiting& waiting) const {
  MonotonicTime due = waiting.arrival;
  if (closed_) return due;
  for (std::size_t i = 0; i < lanes_.size(); ++i) {
    const Lane& other = lanes_[i];
    const Duration patience = std::max(kDelivering, 2 * other.interval);
    const bool delivering = other.last_arrival && waiting.arrival - *other.last_arrival < patience;
    if (i == source || !delivering || !other.frames.empty()) continue;
    due = std::max(due, waiting.arrival + std::max(Duration(0), other.lateness + kMargin - waiting.age));
  }
  return std::min(due, waiting.arrival + config_.merge);
}

/// Of each source's frames that are due the newest stays: map did not keep up with the others.
void FrameQueue::supersede(MonotonicTime now) {
  for (std::size_t i = 0; i < lanes_.size(); ++i) {
    Lane& lane = lanes_[i];
    while (lane.frames.size() > 1 && due(i, lane.frames[1]) <= now) {
      lane.frames.pop_front();
      ++lane.losses.dropped;
    }
  }
}

/// Whether the front of `lane` comes after a later frame; then it is gone.
bool FrameQueue::is_late(Lane& lane) {
  if (!given_ || lane.frames.front().end >= *given_) return false;
  lane.frames.pop_front();
  ++lane.losses.late;
  if (!earliest()) waiting_since_.reset();
  return true;
}

FrameQueue::Entry FrameQueue::take(std::size_t source) {
  Lane& lane = lanes_[source];
  Entry entry{std::move(lane.frames.front().frame), source};
  const Time end = lane.frames.front().end;
  given_ = given_ ? std::max(*given_, end) : end;
  lane.frames.pop_front();
  waiting_since_.reset();
  if (earliest()) waiting_since_ = MonotonicClock::now();
  changed_.notify_all();
  return entry;
}

FrameQueue::Entry FrameQueue::pop(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  while (!stop.stop_requested()) {
    if (merges()) supersede(MonotonicClock::now());
    const auto source = earliest();
    if (!source) {
      if (closed_) return {};
      changed_.wait(lock, stop, [&] { return closed_ || earliest().has_value(); });
      continue;
    }
    if (!merges()) return take(*source);
    if (is_late(lanes_[*source])) continue;
    const MonotonicTime when = due(*source, lanes_[*source].frames.front());
    if (MonotonicClock::now() >= when) return take(*source);
    // what comes meanwhile may be earlier, or release this one
    const auto arrivals = [&] {
      std::size_t waiting = 0;
      for (const Lane& lane : lanes_) waiting += lane.frames.size();
      return waiting;
    };
    changed_.wait_until(lock, stop, when, [&, before = arrivals()] { return closed_ || arrivals() != before; });
  }
  return {};
}

void FrameQueue::close() {
  const std::lock_guard lock(mutex_);
  closed_ = true;
  changed_.notify_all();
}

std::optional<MonotonicTime> FrameQueue::waiting_since() const {
  const std::lock_guard lock(mutex_);
  return waiting_since_;
}

FrameQueue::Losses FrameQueue::losses(std::size_t source) const {
  const std::lock_guard lock(mutex_);
  return lanes_[source].losses;
}

std::uint64_t FrameQueue::dropped() const {
  const std::lock_guard lock(mutex_);
  std::uint64_t sum = 0;
  for (const Lane& lane : lanes_) sum += lane.losses.dropped + lane.losses.late;
  return sum;
}

}  // namespace scree::node
