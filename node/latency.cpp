#include "node/latency.hpp"

#include <algorithm>
#include <cmath>

namespace scree::node {

void LatencyHistogram::add(Duration latency) {
  const double us = std::max(1.0, static_cast<double>(latency.count()) * 1e-3);
  const auto bucket = static_cast<std::size_t>(std::log2(us) * static_cast<double>(kBucketsPerOctave));
  ++buckets_[std::min(bucket, buckets_.size() - 1)];
  ++count_;
  max_ = std::max(max_, latency);
}

Duration LatencyHistogram::percentile(double share) const {
  if (count_ == 0) return Duration{0};
  const auto rank = static_cast<std::uint64_t>(std::ceil(share * static_cast<double>(count_)));
  std::uint64_t seen = 0;
  for (std::size_t i = 0; i < buckets_.size(); ++i) {
    seen += buckets_[i];
    if (seen < std::max<std::uint64_t>(rank, 1)) continue;
    const double upper_us = std::exp2(static_cast<double>(i + 1) / static_cast<double>(kBucketsPerOctave));
    return std::min(max_, Duration(static_cast<std::int64_t>(upper_us * 1e3)));
  }
  return max_;
}

}  // namespace scree::node
