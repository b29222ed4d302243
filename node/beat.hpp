#pragma once
// A thread's sign of life, for who watches it.

#include <atomic>

#include "core/time.hpp"

namespace scree::node {

/// touch() by the thread at every turn; age() by anyone. A thread that waits for work on purpose says so with rest().
class Beat {
 public:
  void touch() { last_ = MonotonicClock::now().time_since_epoch().count(); }
  void rest() { last_ = kResting; }
  /// Since the last touch; 0 while it rests.
  Duration age(MonotonicTime now) const {
    const Duration::rep last = last_;
    return last == kResting ? Duration(0) : now.time_since_epoch() - Duration(last);
  }

 private:
  static constexpr Duration::rep kResting = 0;
  std::atomic<Duration::rep> last_{kResting};
};

}  // namespace scree::node
