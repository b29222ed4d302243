// One small drive over known ground: is the map's judgement better than that of plain methods on the same frames, and
// are its heights as uncertain as it says?

#include <gtest/gtest.h>

#include "tests/bench/map/truth/small_scene.hpp"

namespace scree::bench {
namespace {

// Means and standard deviations over 20 other seeds, from section "spread" of the map's bench. A seed that nobody chose
// is beyond three of these in one of 740 cases; what the map computes is deterministic, so only a change of it can
// fail.
constexpr double kGainOverRelief = 0.103, kGainOverReliefSd = 0.018;
constexpr double kGainOverPlane = 0.163, kGainOverPlaneSd = 0.022;
// Of the 90 % interval; .88 … .92 is the target, which measured cells miss on other ground (docs/map-accuracy.md).
constexpr double kMost = 0.92;
constexpr double kMeasuredCoverage = 0.883, kMeasuredCoverageSd = 0.010;
constexpr double kOpenCoverage = 0.910, kOpenCoverageSd = 0.010;

TEST(Traversability, RiskOfKnownGroundBeatsPlainMethodsAndIntervalsCover) {
#ifndef SCREE_WITH_GDAL
  GTEST_SKIP() << "the simulator reads the ground from a raster";
#endif
  const Judgement scene = judge_small_scene(21);
  const auto& scores = scene.scores[kAllCells];
  ASSERT_GT(scores[kRisk].cells(), 8000.0);
  EXPECT_GT(scores[kRisk].auc() - scores[kRelief].auc(), kGainOverRelief - 3.0 * kGainOverReliefSd);
  EXPECT_GT(scores[kRisk].auc() - scores[kPlane].auc(), kGainOverPlane - 3.0 * kGainOverPlaneSd);

  ASSERT_GT(scene.heights.measured.cells, 5000.0);
  EXPECT_GT(scene.heights.measured.coverage(), kMeasuredCoverage - 3.0 * kMeasuredCoverageSd);
  EXPECT_LT(scene.heights.measured.coverage(), kMost + 3.0 * kMeasuredCoverageSd);
  fractal::PredictionScore open;
  for (const auto& distance : scene.heights.open) open += distance;
  ASSERT_GT(open.cells, 300.0);
  EXPECT_GT(open.coverage(), kOpenCoverage - 3.0 * kOpenCoverageSd);
  EXPECT_LT(open.coverage(), kMost + 3.0 * kOpenCoverageSd);
}

}  // namespace
}  // namespace scree::bench
