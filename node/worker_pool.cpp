#include "node/worker_pool.hpp"

#include <cstdint>

namespace scree::node {

void WorkerPool::for_ranges(int count, const std::function<void(int, int)>& body) {
  if (count <= 0) return;
  if (threads_ == 1 || count == 1) return body(0, count);
  std::unique_lock lock(mutex_);
  body_ = &body;
  count_ = count;
  next_range_ = 0;
  unfinished_ = threads_;
  work_.notify_all();
  run_ranges(lock);
  done_.wait(lock, [this] { return unfinished_ == 0; });
  body_ = nullptr;
}

void WorkerPool::work(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  while (work_.wait(lock, stop, [this] { return body_ != nullptr && next_range_ < threads_; })) run_ranges(lock);
}

void WorkerPool::run_ranges(std::unique_lock<std::mutex>& lock) {
  const auto bound = [this](int range) {
    return static_cast<int>(static_cast<std::int64_t>(count_) * range / threads_);
  };
  while (next_range_ < threads_) {
    const int begin = bound(next_range_);
    const int end = bound(next_range_ + 1);
    ++next_range_;
    const auto& body = *body_;
    lock.unlock();
    if (begin < end) body(begin, end);
    lock.lock();
    if (--unfinished_ == 0) done_.notify_all();
  }
}

}  // namespace scree::node
