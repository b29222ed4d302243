#pragma once
// The health bits: set at once, cleared only after the condition was good for a while, each change logged once.

#include <array>
#include <cstdint>

#include "core/time.hpp"

namespace scree::node {

/// Both clocks at one moment.
struct ClockReading {
  MonotonicTime monotonic;
  Time system;
};
/// Reads them again when the thread was held up between the two; `certain` is false when that happened every time.
ClockReading read_clocks(bool& certain);

/// What the node sees of itself at one moment.
struct Condition {
  MonotonicTime now;
  bool sensor_stale = false;
  bool sensor_lost = false;
  bool pose_stale = false;
  bool recording_failed = false;     ///< live recording ended early or dropped frames
  bool fault = false;                ///< an error of the node itself: stays for good
  std::uint64_t frames_dropped = 0;  ///< ever
};

class HealthState {
 public:
  /// Good for this long before a bit is cleared.
  static constexpr Duration kRecovery = std::chrono::seconds(1);
  /// Frames were dropped: a node that just keeps up drops one now and then.
  static constexpr Duration kOverloadRecovery = std::chrono::seconds(3);
  /// A step of the system clock is told for this long.
  static constexpr Duration kClockRecovery = std::chrono::seconds(10);
  /// What counts as one: NTP slews by 0.5 ms/s at most, and clocks are compared ten times a second.
  static constexpr Duration kClockStep = std::chrono::milliseconds(50);

  /// Logs the bits that changed.
  std::uint16_t update(const Condition& condition);
  /// System clock against monotonic clock: only a reading that is certain.
  void note_clocks(const ClockReading& reading);
  std::uint16_t bits() const { return bits_; }
  /// Times that a bit was set, over all bits.
  std::uint64_t transitions() const { return transitions_; }

 private:
  void judge(std::uint16_t bit, bool bad, MonotonicTime now, Duration recovery);

  std::uint16_t bits_ = 0;
  std::array<MonotonicTime, 16> last_bad_{};
  std::uint64_t frames_dropped_ = 0;
  bool has_offset_ = false;
  Duration offset_{0};  ///< system less monotonic, at the last reading
  bool stepped_ = false;
  std::uint64_t transitions_ = 0;
};

}  // namespace scree::node
