#pragma once
// An Executor over threads that someone else owns: the pipeline makes the threads, this hands them work.

#include <condition_variable>
#include <functional>
#include <mutex>
#include <stop_token>

#include "core/executor.hpp"

namespace scree::node {

/// Loops are cut into `threads` equal ranges. The caller of for_ranges works too, so the pool is complete with
/// threads − 1 threads in work(), and correct with fewer. One loop at a time.
class WorkerPool final : public Executor {
 public:
  explicit WorkerPool(int threads) : threads_(threads < 1 ? 1 : threads) {}

  void for_ranges(int count, const std::function<void(int begin, int end)>& body) override;

  /// What a worker thread runs until `stop`.
  void work(const std::stop_token& stop);

  int threads() const { return threads_; }

 private:
  /// Takes and runs ranges until none is left; `lock` is held on entry and exit, not while the body runs.
  void run_ranges(std::unique_lock<std::mutex>& lock);

  const int threads_;
  std::mutex mutex_;
  std::condition_variable_any work_;
  std::condition_variable done_;
  const std::function<void(int, int)>* body_ = nullptr;
  int count_ = 0;
  int next_range_ = 0;
  int unfinished_ = 0;
};

}  // namespace scree::node
