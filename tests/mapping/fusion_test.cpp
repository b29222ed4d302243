#include "mapping/fusion.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>

#include "tests/mapping/support.hpp"

namespace scree::mapping {
namespace {

GroundReturn returns_of(std::vector<float> heights_m, float sigma_m = 0.01F, StoredHeight stored = {}) {
  const std::vector<float> variances(heights_m.size(), sigma_m * sigma_m);
  return ground_return(heights_m, variances, stored, GroundConfig{});
}

GroundReturn flat(float height_m, int hits = 4, float sigma_m = 0.01F) {
  return returns_of(std::vector<float>(static_cast<std::size_t>(hits), height_m), sigma_m);
}

TEST(GroundReturn, CanopyIsNotAveragedIntoTheGround) {
  const GroundReturn seen = returns_of({0.01F, 2.4F, 2.5F, 2.6F, 2.5F, -0.01F});
  EXPECT_NEAR(seen.height_m, 0.0F, 1e-6F);
  EXPECT_EQ(seen.hits, 2);
  EXPECT_EQ(seen.others, 4);
  EXPECT_LT(seen.relief_m2, 1e-3F);
}

TEST(GroundReturn, EdgeInsideACellKeepsOneSideAndRemembersTheRelief) {
  const GroundReturn seen = returns_of({0.0F, 0.0F, 0.5F, 0.5F, 0.5F});
  EXPECT_FLOAT_EQ(seen.height_m, 0.5F);
  EXPECT_EQ(seen.hits, 3);
  EXPECT_NEAR(seen.relief_m2, 0.4F * 0.25F, 1e-3F);
}

TEST(GroundReturn, EdgeInsideACellStaysOnTheSideTheMapAlreadyHolds) {
  const GroundReturn seen = returns_of({0.0F, 0.0F, 0.5F, 0.5F, 0.5F}, 0.01F, {0.01F, 1e-4F});
  EXPECT_FLOAT_EQ(seen.height_m, 0.0F);
}

TEST(GroundReturn, OneStrayLowReturnAmongManyIsNotTheGround) {
  std::vector<float> heights(20, 0.0F);
  heights.push_back(-3.0F);
  const GroundReturn seen = returns_of(heights);
  EXPECT_FLOAT_EQ(seen.height_m, 0.0F);
  EXPECT_EQ(seen.others, 1);
}

TEST(GroundReturn, SlopingCellIsOneSurface) {
  const GroundReturn seen = returns_of({0.00F, 0.03F, 0.06F, 0.10F});
  EXPECT_EQ(seen.hits, 4);
  EXPECT_EQ(seen.others, 0);
}

TEST(GroundReturn, RangeNoiseIsAveragedAway) {
  const GroundReturn many = returns_of(std::vector<float>(1000, 0.0F));
  EXPECT_NEAR(many.noise_variance_m2, 1e-7F, 1e-9F);
  EXPECT_FLOAT_EQ(returns_of({0.0F}).noise_variance_m2, 1e-4F);
}

TEST(Fusion, RepeatedAgreementConvergesToTheMeanAndNeverBelowTheSystematicFloor) {
  MapCell cell;
  for (int i = 0; i < 1000; ++i) fuse_cell(flat(i % 2 == 0 ? 1.0F : 1.01F), GroundConfig{}, cell);
  EXPECT_NEAR(cell.height_m, 1.005F, 2e-3F);
  EXPECT_EQ(cell.hits, 4000);
  EXPECT_GT(height_variance_m2(cell, 0.1F), kSystematic_m * kSystematic_m);
  EXPECT_LT(height_variance_m2(cell, 0.1F), 4 * kSystematic_m * kSystematic_m);
}

TEST(Fusion, OneContradictionChangesNothingAndIsCounted) {
  MapCell cell;
  fuse_cell(flat(0.0F), GroundConfig{}, cell);
  const FusionCounts counts = fuse_cell(flat(0.6F), GroundConfig{}, cell);
  EXPECT_EQ(counts.outlier, 4U);
  EXPECT_FLOAT_EQ(cell.height_m, 0.0F);
}

TEST(Fusion, PersistentContradictionReplacesTheHeightWithinAFewFrames) {
  MapCell cell;
  for (int i = 0; i < 50; ++i) fuse_cell(flat(0.6F), GroundConfig{}, cell);
  int frames = 0;
  while (cell.height_m > 0.3F && frames < 100) {
    fuse_cell(flat(0.0F), GroundConfig{}, cell);
    ++frames;
  }
  EXPECT_EQ(frames, kFramesToReplace);
  EXPECT_FLOAT_EQ(cell.height_m, 0.0F);
}

TEST(Fusion, FewReturnsDoNotOutvoteOneFrameOfMany) {
  MapCell cell;
  fuse_cell(flat(0.3F, 2), GroundConfig{}, cell);  // mixed pixels that hang in the shadow of an edge
  const FusionCounts counts = fuse_cell(flat(0.0F, 2 * kReturnsToReplace), GroundConfig{}, cell);
  EXPECT_EQ(counts.fused, 2U * kReturnsToReplace);
  EXPECT_FLOAT_EQ(cell.height_m, 0.0F);
  fuse_cell(flat(0.3F, 2 * kReturnsToReplace), GroundConfig{}, cell);  // and not the other way round
  EXPECT_FLOAT_EQ(cell.height_m, 0.0F);
}

TEST(Fusion, OverhangSeenLaterNeverReplacesTheGround) {
  MapCell cell;
  fuse_cell(flat(0.0F), GroundConfig{}, cell);
  for (int i = 0; i < 20; ++i) EXPECT_EQ(fuse_cell(flat(2.5F), GroundConfig{}, cell).other_surface, 4U);
  EXPECT_FLOAT_EQ(cell.height_m, 0.0F);
}

// A crown of which only the top was hit, while rays to farther ground passed below: no ground seven metres up.
TEST(Fusion, WhatHangsAboveRaysThatPassedIsNoGround) {
  MapCell cell;
  cell.ceiling_m = 0.2F;
  const FusionCounts counts = fuse_cell(flat(7.0F, 3), GroundConfig{}, cell);
  EXPECT_EQ(counts.other_surface, 3U);
  EXPECT_EQ(counts.fused, 0U);
  EXPECT_FALSE(cell.measured());
  fuse_cell(flat(1.1F, 3), GroundConfig{}, cell);  // a wall that rays passed beside: within a vehicle's height
  EXPECT_TRUE(cell.measured());
}

TEST(Fusion, GroundSeenLaterReplacesAnOverhang) {
  MapCell cell;
  fuse_cell(flat(2.5F), GroundConfig{}, cell);
  for (int i = 0; i < kFramesToReplace; ++i) fuse_cell(flat(0.0F), GroundConfig{}, cell);
  EXPECT_FLOAT_EQ(cell.height_m, 0.0F);
}

TEST(Fusion, EveryPointIsCountedOnce) {
  PointFrame frame = test::empty_frame({0, 0, 2});
  for (int i = 0; i < 2000; ++i) {
    const auto xy = random_normals(1, 1, i, 0);
    const auto z = random_normals(1, 1, i, 1);
    test::add_point(frame, xy[0], xy[1], z[0], 0.02);
  }
  frame.z_m[7] = std::numeric_limits<float>::quiet_NaN();
  frame.x_m[9] = std::numeric_limits<float>::infinity();
  frame.range_variance_m2[11] = std::numeric_limits<float>::quiet_NaN();
  SerialExecutor serial;
  RollingGrid<MapCell> map(20, 20, {});
  map.roll_to({-10, -10});
  CellPoints points;
  FrameReturns returns;
  Fusion fusion(GroundConfig{});
  for (int pass = 0; pass < 3; ++pass) {
    points.sort(frame, map.window(), 0.1, serial);
    returns.gather(frame, {}, points, map, GroundConfig{}, serial);
    const FusionCounts counts = fusion.fuse(returns, 0, GateLaw(), serial, map);
    EXPECT_EQ(counts.fused + counts.outlier + counts.other_surface + points.outside(), frame.size());
    EXPECT_GT(points.outside(), 3U);
    EXPECT_GT(counts.fused, 0U);
  }
}

TEST(CellPoints, KeepTheFramesOrderInsideEveryCellForAnyExecutor) {
  PointFrame frame = test::empty_frame({0, 0, 2});
  for (int i = 0; i < 500; ++i) {
    const auto xy = random_normals(2, 1, i, 0);
    test::add_point(frame, xy[0], xy[1], i);
  }
  const LatticeWindow window{{-8, -8}, 16, 16};
  SerialExecutor serial;
  test::ReversedRanges reversed(7);
  CellPoints points, other;
  points.sort(frame, window, 0.1, serial);
  other.sort(frame, window, 0.1, reversed);
  std::size_t seen = 0;
  for (int row = 0; row < 16; ++row)
    for (int column = 0; column < 16; ++column) {
      const auto heights = points.heights_m(row, column);
      EXPECT_TRUE(std::is_sorted(heights.begin(), heights.end()));
      EXPECT_TRUE(std::ranges::equal(heights, other.heights_m(row, column)));
      for (const float z : heights) {
        const auto i = static_cast<std::size_t>(z);
        EXPECT_EQ(lattice_cell(static_cast<double>(frame.x_m[i]), static_cast<double>(frame.y_m[i]), 0.1),
                  (CellIndex{-8 + column, -8 + row}));
        ++seen;
      }
    }
  EXPECT_EQ(seen + points.outside(), frame.size());
}

}  // namespace
}  // namespace scree::mapping
