#pragma once
// Frames on their way from acquire to map.

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <stop_token>

#include "drivers/frame/range_frame.hpp"

namespace scree::node {

enum class QueuePolicy {
  lossless,     ///< replay: a full queue makes the producer wait
  newest_wins,  ///< live: a full queue loses its oldest frame, counted
};

class FrameQueue {
 public:
  FrameQueue(QueuePolicy policy, std::size_t capacity) : policy_(policy), capacity_(capacity) {}

  /// False when `stop` came while waiting for room.
  bool push(std::shared_ptr<const RangeFrame> frame, const std::stop_token& stop);
  /// Null when the queue is closed and empty, or on `stop`.
  std::shared_ptr<const RangeFrame> pop(const std::stop_token& stop);
  /// No frame will follow; what is in the queue still comes out.
  void close();

  std::uint64_t dropped() const;

 private:
  const QueuePolicy policy_;
  const std::size_t capacity_;
  mutable std::mutex mutex_;
  std::condition_variable_any changed_;
  std::deque<std::shared_ptr<const RangeFrame>> frames_;
  std::uint64_t dropped_ = 0;
  bool closed_ = false;
};

}  // namespace scree::node
