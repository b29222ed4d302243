#include "node/latency.hpp"

#include <cmath>
#include <gtest/gtest.h>

namespace scree::node {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

TEST(LatencyHistogram, PercentilesAreWithinABucketOfTheTruth) {
  LatencyHistogram histogram;
  for (int i = 1; i <= 1000; ++i) histogram.add(microseconds(i * 50));  // 50 µs … 50 ms, evenly
  const double bucket = std::exp2(1.0 / 32);
  for (const double share : {0.1, 0.5, 0.9, 0.99}) {
    const double truth_ns = share * 1000 * 50e3;
    EXPECT_GE(static_cast<double>(histogram.percentile(share).count()), truth_ns);
    EXPECT_LE(static_cast<double>(histogram.percentile(share).count()), truth_ns * bucket);
  }
  EXPECT_EQ(histogram.max(), milliseconds(50));
  EXPECT_EQ(histogram.percentile(1.0), milliseconds(50));
}

TEST(LatencyHistogram, EmptyIsZeroAndExtremesFit) {
  LatencyHistogram histogram;
  EXPECT_EQ(histogram.percentile(0.5).count(), 0);
  histogram.add(Duration{-5});
  histogram.add(std::chrono::hours(1000));
  EXPECT_EQ(histogram.count(), 2u);
  EXPECT_LE(histogram.percentile(0.5), microseconds(2));
}

}  // namespace
}  // namespace scree::node
