#include "drivers/v4l2_image.hpp"

#include <algorithm>
#include <cstring>

#include "core/simd.hpp"

namespace scree::drivers::v4l2 {
namespace {

SCREE_CLONES void read_row(const std::uint8_t* bytes, std::uint16_t mask, std::size_t columns, std::uint16_t* counts) {
  for (std::size_t c = 0; c < columns; ++c) {
    std::uint16_t word = 0;
    std::memcpy(&word, bytes + 2 * c, 2);
    counts[c] = word & mask;
  }
}

}  // namespace

void read_counts(std::span<const std::uint8_t> bytes, const Image& image, Grid<std::uint16_t>& counts) {
  counts.reshape(image.rows, image.columns);
  for (int r = 0; r < image.rows; ++r)
    read_row(bytes.data() + static_cast<std::size_t>(r) * image.bytes_per_line, image.format->mask,
             static_cast<std::size_t>(image.columns), counts.row(r).data());
}

ClockReading read_clocks() {
  ClockReading best{};
  Duration tightest = Duration::max();
  for (int i = 0; i < 3; ++i) {
    const auto before = MonotonicClock::now();
    const auto unix = std::chrono::time_point_cast<Duration>(std::chrono::system_clock::now());
    const auto after = MonotonicClock::now();
    if (after - before >= tightest) continue;
    tightest = after - before;
    best = {before + tightest / 2, unix};
  }
  return best;
}

Time StampClock::unix_time(MonotonicTime stamp, const ClockReading& now) {
  if (stamp > now.monotonic || now.monotonic - stamp > kOldest) {
    stamp = now.monotonic;
    ++implausible_;
  }
  const Duration offset = now.unix.time_since_epoch() - now.monotonic.time_since_epoch();
  const auto with = [&](Duration of) { return Time(stamp.time_since_epoch() + of); };
  Time time = with(offset);
  if (any_ && time <= last_) {
    ++held_;
    time = std::max(with(offset_), last_ + Duration(1));
  } else {
    offset_ = offset;
  }
  any_ = true;
  last_ = time;
  return time;
}

void SequenceCounter::note(std::uint32_t sequence) {
  std::uint32_t step = 1;
  if (running_) {
    step = sequence - last_;  // modulo 2^32, so that it may wrap
    if (step == 0 || step > 0x7FFF'FFFFU) step = 1;
    missing_ += step - 1;
  }
  if (any_) number_ += step;
  any_ = running_ = true;
  last_ = sequence;
}

}  // namespace scree::drivers::v4l2
