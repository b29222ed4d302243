// What the pipeline's threads count and tell each other, and what it says of itself.

#include <array>
#include <chrono>
#include <cstdint>
#include <spdlog/spdlog.h>
#include <utility>

#include "node/pipeline.hpp"
#include "node/protocol_header.hpp"
#include "node/saturate.hpp"

namespace scree::node {
namespace {

constexpr std::array<const char*, 4> kStateNames{"no frame yet", "frames come", "stale", "lost"};

/// A row's pose as it goes out.
protocol::PoseMessage pose_message(const RangeFrame& frame) {
  const std::size_t middle = frame.row_time.size() / 2;
  protocol::PoseMessage message;
  message.time = frame.row_time[middle];
  message.T_map_body = frame.T_map_body[middle];
  for (int axis = 0; axis < 3; ++axis) {
    const auto i = static_cast<std::size_t>(axis);
    message.variances[i] = static_cast<float>(frame.pose_variance.position_m2[axis]);
    message.variances[3 + i] = static_cast<float>(frame.pose_variance.attitude_rad2[axis]);
  }
  return message;
}

}  // namespace

protocol::ByeReason Pipeline::bye_reason() const {
  if (error()) return protocol::ByeReason::failed;  // also when the failure is what requested the stop
  return stop_.stop_requested() ? protocol::ByeReason::stopped : protocol::ByeReason::finished;
}

void Pipeline::report_pose(const RangeFrame& frame) {
  if (frame.row_time.empty()) return;
  const auto delivered = poses_ != nullptr ? poses_->delivered() : std::nullopt;
  poses_out_.add({pose_message(frame), delivered.value_or(frame.received)});
}

void Pipeline::note_first_frame() {
  const std::lock_guard lock(mutex_);
  if (!first_taken_) first_taken_ = MonotonicClock::now();
}

void Pipeline::copy_publisher_counters() {
  const LatencyHistogram& latency = publisher_->latency();
  const std::lock_guard lock(mutex_);
  statistics_.publisher = publisher_->counters();
  statistics_.subscriptions = publisher_->subscriptions();
  statistics_.subscribers = publisher_->subscribers();
  statistics_.latency_out_p50 = latency.percentile(0.5);
  statistics_.latency_out_p99 = latency.percentile(0.99);
  statistics_.latency_out_max = latency.max();
  statistics_.health_changes = health_.transitions();
}

/// Under the lock. One sensor that is stale or lost is enough for the bit: HEARTBEAT says which.
void Pipeline::judge_sensors(NodeStatus& status, Condition& condition) {
  using protocol::SensorState;
  const auto& node = config_.settings.node;
  for (std::size_t i = 0; i < source_states_.size(); ++i) {
    SourceState& source = source_states_[i];
    const auto age = std::chrono::duration_cast<std::chrono::milliseconds>(condition.now - source.last_frame);
    const bool lost = live() && (source.ended || age.count() > node.sensor_lost_ms);
    const bool stale = live() && age.count() > node.sensor_stale_ms;
    condition.sensor_stale = condition.sensor_stale || stale;
    condition.sensor_lost = condition.sensor_lost || lost;
    SensorState state = lost ? SensorState::lost : stale ? SensorState::stale : SensorState::ok;
    if (!source.has_frame) state = SensorState::waiting;
    status.sensors[i] = {static_cast<std::uint8_t>(i), state, saturate<std::uint32_t>(age.count())};
  }
  status.sensor_count = static_cast<std::uint8_t>(source_states_.size());
}

/// With several sources: what changed since it was told. Outside the lock, for a log may block.
void Pipeline::tell_sensors(const NodeStatus& status) {
  if (names_.size() < 2) return;
  for (std::size_t i = 0; i < names_.size(); ++i) {
    const auto state = status.sensors[i].state;
    if (std::exchange(told_[i], state) != state)
      spdlog::info("source {}: {}", names_[i], kStateNames[static_cast<std::size_t>(state)]);
  }
}

/// Since the publish thread looked last: a frame that was lost, or the whole rest of them.
bool Pipeline::recording_is_incomplete() {
  const RecorderCounters counters = recorder_->counters();
  const std::uint64_t lost = counters.dropped + counters.refused;
  return std::exchange(recording_lost_, lost) != lost || counters.failed;
}

/// Of the publish thread.
NodeStatus Pipeline::status(MonotonicTime now) {
  const auto dropped = queue_.dropped();
  bool certain = false;
  if (const ClockReading clocks = read_clocks(certain); certain) health_.note_clocks(clocks);
  const auto newest_pose = poses_come_by_udp() ? inbox_->poses().newest() : std::nullopt;
  const std::chrono::milliseconds max_pose_age(config_.settings.pose.max_age_ms);
  NodeStatus status;
  Condition condition;
  condition.now = now;
  condition.frames_dropped = status.frames_dropped = dropped;
  condition.pose_stale = poses_come_by_udp() && (!newest_pose || now - newest_pose->delivered > max_pose_age);
  {
    const std::lock_guard lock(mutex_);
    status.frames_in = statistics_.frames_in;
    status.origin = origin_;
    judge_sensors(status, condition);
    condition.pose_stale = condition.pose_stale || pose_stale_;
    condition.fault = faulty_;
  }
  tell_sensors(status);
  if (recorder_) condition.recording_failed = recording_is_incomplete();
  condition.fault = condition.fault || publisher_->error().has_value();
  status.health = health_.update(condition);
  return status;
}

void Pipeline::fail(Error error, bool fault) {
  const std::lock_guard lock(mutex_);
  faulty_ = faulty_ || fault;
  if (!error_) error_ = std::move(error);
}

Statistics Pipeline::statistics() const {
  const auto dropped = queue_.dropped();
  const std::lock_guard lock(mutex_);
  Statistics statistics = statistics_;
  statistics.frames_dropped = dropped;
  for (std::size_t i = 0; i < source_states_.size(); ++i) {
    const FrameQueue::Losses losses = queue_.losses(i);
    statistics.sources.push_back(source_states_[i].statistics);
    statistics.sources.back().frames_dropped = losses.dropped;
    statistics.sources.back().frames_late = losses.late;
  }
  if (recorder_) statistics.recorder = recorder_->counters();
  statistics.latency_p50 = latency_.percentile(0.5);
  statistics.latency_p99 = latency_.percentile(0.99);
  statistics.latency_max = latency_.max();
  statistics.elapsed = MonotonicClock::now() - start_;
  return statistics;
}

std::shared_ptr<const mapping::MapSnapshot> Pipeline::map() const {
  const std::lock_guard lock(mutex_);
  return map_;
}

std::optional<Error> Pipeline::error() const {
  const std::lock_guard lock(mutex_);
  return error_;
}

std::optional<Error> Pipeline::publish_error() const {
  const std::lock_guard lock(mutex_);
  return publish_error_;
}

}  // namespace scree::node
