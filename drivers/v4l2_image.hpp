#pragma once
// What is pure in the V4L2 source: images in buffers → counts, driver's time stamps → Unix time.

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/grid.hpp"
#include "core/time.hpp"
#include "drivers/v4l2_formats.hpp"

namespace scree::drivers::v4l2 {

/// What was agreed with the device.
struct Image {
  const RangeFormat* format = nullptr;
  int rows = 0, columns = 0;
  std::size_t bytes_per_line = 0;  ///< from one row to the next; padding behind the columns
  double rate_hz = 0.0;            ///< 0 = the device does not say

  /// Of a whole image. The last row needs no padding.
  std::size_t bytes() const {
    return bytes_per_line * static_cast<std::size_t>(rows - 1) + 2 * static_cast<std::size_t>(columns);
  }
};

/// The counts of `bytes`, without padding and without the bits that are none. `bytes` must hold image.bytes(). No
/// allocation when `counts` has the image's size already. One load, mask and store a pixel, vectorised.
void read_counts(std::span<const std::uint8_t> bytes, const Image& image, Grid<std::uint16_t>& counts);

/// Both clocks at the same moment.
struct ClockReading {
  MonotonicTime monotonic;
  Time unix;
};

/// The most tightly bracketed of three readings: a thread that is interrupted between two clocks would shift the frame.
ClockReading read_clocks();

/// Monotonic stamps → Unix times that strictly increase.
///
/// The offset between the clocks is that at the frame, so the times follow the system's clock while it is slewed or set
/// forward. When it is set back behind the last frame, the offset stays what it was until the clock has caught up: the
/// times go on at the rate of the frames, never backwards.
class StampClock {
 public:
  /// `stamp` is taken for the moment of arrival, now.monotonic, when it lies in the future or more than kOldest back:
  /// drivers are known that say 0 or the time of another clock.
  Time unix_time(MonotonicTime stamp, const ClockReading& now);

  std::uint64_t implausible() const { return implausible_; }
  std::uint64_t held() const { return held_; }  ///< frames whose offset was not that of the clock

  static constexpr Duration kOldest = std::chrono::seconds(10);

 private:
  bool any_ = false;
  Time last_{};
  Duration offset_{0};
  std::uint64_t implausible_ = 0;
  std::uint64_t held_ = 0;
};

/// Numbers of buffers, 32 bits that begin anew with every start, → how many were left out, and numbers that never do.
class SequenceCounter {
 public:
  /// The device was started: the next number follows nothing.
  void restart() { running_ = false; }
  /// A number that is that of the buffer before or lies behind it is no news: drivers are known that always say 0.
  void note(std::uint32_t sequence);

  std::uint64_t number() const { return number_; }    ///< of the last buffer, from 0
  std::uint64_t missing() const { return missing_; }  ///< between buffers of the same run

 private:
  bool any_ = false;
  bool running_ = false;
  std::uint32_t last_ = 0;
  std::uint64_t number_ = 0;
  std::uint64_t missing_ = 0;
};

}  // namespace scree::drivers::v4l2
