#pragma once
// Percentiles of durations without keeping them.

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/time.hpp"

namespace scree::node {

/// A histogram with 32 buckets an octave from 1 µs: a percentile is right within 2.2 %, from 1 µs to 19 hours. No
/// allocation.
class LatencyHistogram {
 public:
  void add(Duration latency);
  /// The upper edge of the bucket that holds the fraction `share` (0 … 1); 0 when empty, never above the maximum.
  Duration percentile(double share) const;
  Duration max() const { return max_; }
  std::uint64_t count() const { return count_; }

 private:
  static constexpr std::size_t kBucketsPerOctave = 32;
  std::array<std::uint64_t, 36 * kBucketsPerOctave + 1> buckets_{};
  std::uint64_t count_ = 0;
  Duration max_{0};
};

}  // namespace scree::node
