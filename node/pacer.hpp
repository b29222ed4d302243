#pragma once
// Releases data at its own pace.

#include <algorithm>
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
  /// The data begins again: the next time given is due one interval (that of the last two times) after the last one.
  void restart() {
    first_.reset();
    restarted_ = true;
  }

  /// Waits until `time` is due; false on `stop`.
  bool wait(Time time, const std::stop_token& stop) {
    if (!rate_) return !stop.stop_requested();
    if (!first_) {
      first_ = time;
      start_ = restarted_ ? std::max(due_ + interval_, MonotonicClock::now()) : MonotonicClock::now();
      due_ = start_;
    }
    const auto due = start_ + std::chrono::duration_cast<Duration>((time - *first_) / *rate_);
    if (due > due_) interval_ = due - due_;
    due_ = due;
    std::unique_lock lock(mutex_);
    wake_.wait_until(lock, stop, due, [] { return false; });
    return !stop.stop_requested();
  }

 private:
  std::optional<double> rate_;
  std::optional<Time> first_;
  MonotonicTime start_;
  MonotonicTime due_;     ///< of the last time given
  Duration interval_{0};  ///< between the last two
  bool restarted_ = false;
  std::mutex mutex_;
  std::condition_variable_any wake_;
};

}  // namespace scree::node
