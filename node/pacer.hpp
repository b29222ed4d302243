#pragma once
// Releases data at its own pace.

#include <condition_variable>
#include <mutex>
#include <optional>
#include <stop_token>

#include "core/time.hpp"

namespace scree::node {

/// `rate` times as fast as the data's own clock; without a rate as fast as it comes.
class Pacer {
 public:
  explicit Pacer(std::optional<double> rate) : rate_(rate) {}

  bool paced() const { return rate_.has_value(); }
  /// The next time given is due at once.
  void restart() { first_.reset(); }

  /// Waits until `time` is due; false on `stop`.
  bool wait(Time time, const std::stop_token& stop) {
    if (!rate_) return !stop.stop_requested();
    if (!first_) {
      first_ = time;
      start_ = MonotonicClock::now();
    }
    const auto due = start_ + std::chrono::duration_cast<Duration>((time - *first_) / *rate_);
    std::unique_lock lock(mutex_);
    wake_.wait_until(lock, stop, due, [] { return false; });
    return !stop.stop_requested();
  }

 private:
  std::optional<double> rate_;
  std::optional<Time> first_;
  MonotonicTime start_;
  std::mutex mutex_;
  std::condition_variable_any wake_;
};

}  // namespace scree::node
