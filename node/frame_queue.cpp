#include "node/frame_queue.hpp"

#include <utility>

namespace scree::node {

bool FrameQueue::push(std::shared_ptr<const RangeFrame> frame, const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  if (policy_ == QueuePolicy::lossless) {
    if (!changed_.wait(lock, stop, [this] { return frames_.size() < capacity_; })) return false;
  } else {
    while (frames_.size() >= capacity_) {
      frames_.pop_front();
      ++dropped_;
    }
  }
  frames_.push_back(std::move(frame));
  changed_.notify_all();
  return true;
}

std::shared_ptr<const RangeFrame> FrameQueue::pop(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  if (!changed_.wait(lock, stop, [this] { return closed_ || !frames_.empty(); })) return nullptr;
  if (frames_.empty()) return nullptr;
  auto frame = std::move(frames_.front());
  frames_.pop_front();
  changed_.notify_all();
  return frame;
}

void FrameQueue::close() {
  const std::lock_guard lock(mutex_);
  closed_ = true;
  changed_.notify_all();
}

std::uint64_t FrameQueue::dropped() const {
  const std::lock_guard lock(mutex_);
  return dropped_;
}

}  // namespace scree::node
