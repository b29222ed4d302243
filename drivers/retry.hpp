#pragma once
// When a device that is not there is looked for again.

#include <algorithm>
#include <chrono>

#include "core/time.hpp"

namespace scree::drivers {

/// Retries begin at the first and double up to the second.
inline constexpr std::chrono::milliseconds kFirstRetry{100};
inline constexpr std::chrono::milliseconds kLastRetry{2000};

class Retry {
 public:
  explicit Retry(std::chrono::milliseconds first = kFirstRetry, std::chrono::milliseconds last = kLastRetry)
      : first_(first), last_(last) {}

  /// The next attempt is due after the present wait, the one after it after twice that.
  void wait() {
    at_ = MonotonicClock::now() + wait_;
    wait_ = std::min(2 * wait_, last_);
  }
  /// All is well: the next loss is followed by a short wait again.
  void reset() { wait_ = first_; }
  /// The next attempt is due at once.
  void hurry() { at_ = {}; }
  MonotonicTime at() const { return at_; }

 private:
  std::chrono::milliseconds first_, last_;
  std::chrono::milliseconds wait_ = first_;
  MonotonicTime at_{};
};

}  // namespace scree::drivers
