// What the pipeline's threads count and tell each other, and what it says of itself.

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <spdlog/spdlog.h>
#include <utility>

#include "node/pipeline.hpp"
#include "node/protocol_header.hpp"

namespace scree::node {
namespace {

constexpr std::uint64_t kSkippedShown = 10;

std::uint32_t to_us(Duration duration) {
  return static_cast<std::uint32_t>(std::clamp<std::int64_t>(duration.count() / 1000, 0, UINT32_MAX));
}

}  // namespace

protocol::ByeReason Pipeline::bye_reason() const {
  if (error()) return protocol::ByeReason::failed;  // also when the failure is what requested the stop
  return stop_.stop_requested() ? protocol::ByeReason::stopped : protocol::ByeReason::finished;
}

void Pipeline::count_rejected() {
  const auto rejected = input_->counters().rejected;
  const std::lock_guard lock(mutex_);
  statistics_.rejected = rejected;
}

void Pipeline::note_first_frame() {
  const std::lock_guard lock(mutex_);
  if (!first_taken_) first_taken_ = MonotonicClock::now();
}

void Pipeline::copy_publisher_counters() {
  const auto& counters = publisher_->counters();
  const std::lock_guard lock(mutex_);
  statistics_.publisher = counters;
}

NodeStatus Pipeline::status(MonotonicTime now) {
  const auto dropped = queue_.dropped();
  const std::lock_guard lock(mutex_);
  const auto age = std::chrono::duration_cast<std::chrono::milliseconds>(now - last_frame_);
  if (now - last_look_ >= std::chrono::seconds(1)) {
    overloaded_ = dropped > dropped_at_last_look_;
    dropped_at_last_look_ = dropped;
    last_look_ = now;
  }
  NodeStatus status;
  status.frames_in = statistics_.frames_in;
  status.frames_dropped = dropped;
  status.origin = origin_;
  status.latency_p50_us = to_us(latency_.percentile(0.5));
  status.latency_p99_us = to_us(latency_.percentile(0.99));
  status.latency_max_us = to_us(latency_.max());
  status.sensor_age_ms = static_cast<std::uint32_t>(std::clamp<std::int64_t>(age.count(), 0, UINT32_MAX));
  const bool live = config_.policy == QueuePolicy::newest_wins;
  const auto& node = config_.settings.node;
  using namespace protocol;  // the health bits
  unsigned health = 0;
  if (pose_stale_) health |= kHealthPoseStale;
  if (overloaded_) health |= kHealthOverload;
  if (live && age.count() > node.sensor_stale_ms) health |= kHealthSensorStale;
  if (live && (source_ended_ || age.count() > node.sensor_lost_ms)) health |= kHealthSensorLost;
  status.health = static_cast<std::uint16_t>(health);
  return status;
}

void Pipeline::count_skipped(const std::string& message) {
  std::uint64_t skipped = 0;
  {
    const std::lock_guard lock(mutex_);
    skipped = ++statistics_.frames_skipped;
  }
  if (skipped <= kSkippedShown) spdlog::warn("frame skipped: {}", message);
  if (skipped == kSkippedShown) spdlog::warn("further skipped frames are only counted");
}

void Pipeline::fail(Error error) {
  const std::lock_guard lock(mutex_);
  if (!error_) error_ = std::move(error);
}

Statistics Pipeline::statistics() const {
  const auto dropped = queue_.dropped();
  const std::lock_guard lock(mutex_);
  Statistics statistics = statistics_;
  statistics.frames_dropped = dropped;
  statistics.latency_p50 = latency_.percentile(0.5);
  statistics.latency_p99 = latency_.percentile(0.99);
  statistics.latency_max = latency_.max();
  statistics.elapsed = MonotonicClock::now() - start_;
  return statistics;
}

void Pipeline::copy_source_counters() {
  const auto counters = source_->counters();
  const std::lock_guard lock(mutex_);
  statistics_.source = counters;
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
