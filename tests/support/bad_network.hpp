#pragma once
// One direction of a bad network: datagrams go in, and come out late, twice, damaged or not at all. What happens to the
// i-th datagram depends on the seed and i alone, so a run with a given clock repeats exactly.

#include <chrono>
#include <cstdint>
#include <queue>
#include <span>
#include <vector>

namespace scree::test {

using Nanoseconds = std::chrono::nanoseconds;

/// Shares are of all datagrams, 0 … 1.
struct BadNetworkSettings {
  double loss = 0.0;          ///< each by itself
  double burst_loss = 0.0;    ///< share lost in bursts (Gilbert–Elliott, everything is lost in the bad state)
  double burst_length = 5.0;  ///< mean datagrams of a burst
  double duplicate = 0.0;
  double reorder = 0.0;  ///< held back by reorder_delay
  double corrupt = 0.0;  ///< 1 … 8 bits flipped
  double truncate = 0.0;
  Nanoseconds delay{0};
  Nanoseconds jitter{0};  ///< uniform, on top
  Nanoseconds reorder_delay = std::chrono::milliseconds(3);
};

struct BadNetworkCounters {
  std::uint64_t received = 0;
  std::uint64_t delivered = 0;
  std::uint64_t lost = 0;
  std::uint64_t blacked_out = 0;
  std::uint64_t duplicated = 0;
  std::uint64_t reordered = 0;
  std::uint64_t corrupted = 0;
  std::uint64_t truncated = 0;
};

class BadNetwork {
 public:
  BadNetwork(const BadNetworkSettings& settings, std::uint64_t seed) : settings_(settings), seed_(seed) {}

  void set_black_out(bool on) { black_out_ = on; }
  void send(std::span<const std::uint8_t> datagram, Nanoseconds now);
  /// Calls take(bytes) for everything that has arrived by `now`, in order of arrival.
  template <class Take>
  void deliver(Nanoseconds now, Take take) {
    while (!flying_.empty() && flying_.top().due <= now) {
      const std::vector<std::uint8_t> bytes = flying_.top().bytes;
      flying_.pop();
      ++counters_.delivered;
      take(std::span<const std::uint8_t>(bytes));
    }
  }
  /// When the next one arrives; Nanoseconds::max() when nothing is on its way.
  Nanoseconds next_due() const { return flying_.empty() ? Nanoseconds::max() : flying_.top().due; }
  const BadNetworkCounters& counters() const { return counters_; }

 private:
  struct Flying {
    Nanoseconds due;
    std::uint64_t order;
    std::vector<std::uint8_t> bytes;
    bool operator<(const Flying& other) const {  // for std::priority_queue: the earliest on top
      return due != other.due ? due > other.due : order > other.order;
    }
  };
  void launch(std::span<const std::uint8_t> datagram, Nanoseconds now, std::uint64_t index, std::int32_t copy);
  bool lose(std::uint64_t index);

  BadNetworkSettings settings_;
  std::uint64_t seed_;
  bool black_out_ = false;
  bool in_burst_ = false;
  std::uint64_t order_ = 0;
  std::priority_queue<Flying> flying_;
  BadNetworkCounters counters_;
};

}  // namespace scree::test
