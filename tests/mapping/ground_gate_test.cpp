#include "mapping/ground_gate.hpp"

#include <cmath>
#include <gtest/gtest.h>

#include "mapping/fusion.hpp"
#include "mapping/mapper.hpp"
#include "tests/mapping/support.hpp"

namespace scree::mapping {
namespace {

/// Flat ground, one return in the middle of each cell of 4 m × 4 m, and what `over` says instead where it is finite.
PointFrame flat_with(const std::function<double(int x, int y)>& over) {
  PointFrame frame = test::empty_frame({0, 0, 2});
  for (int y = -20; y < 20; ++y)
    for (int x = -20; x < 20; ++x) {
      const double z = over(x, y);
      test::add_point(frame, 0.1 * x + 0.05, 0.1 * y + 0.05, std::isfinite(z) ? z : 0.0, 0.01);
    }
  return frame;
}

const double kGround = std::nan("");

MapConfig small_map() {
  MapConfig config;
  config.size_cells = 60;
  return config;
}

struct Seen {
  SerialExecutor serial;
  Mapper mapper{small_map(), serial};
  StepReport look(const PointFrame& frame) { return *mapper.integrate(frame); }
  float height_m(int x, int y) {
    const auto map = mapper.snapshot();
    return map->hits(y - map->window.min.y, x - map->window.min.x) > 0
               ? map->elevation_m(y - map->window.min.y, x - map->window.min.x)
               : std::nanf("");
  }
};

TEST(GroundGate, AReturnThatHangsAloneInTheAirIsNoGroundAndIsCounted) {
  Seen seen;
  const auto report = seen.look(flat_with([](int x, int y) { return x == 3 && y == 5 ? 0.6 : kGround; }));
  EXPECT_EQ(report.points_unsupported, 1U);
  EXPECT_EQ(report.points_outlier, 1U);
  EXPECT_TRUE(std::isnan(seen.height_m(3, 5)));
}

TEST(GroundGate, ARockOfThreeByThreeCellsIsGround) {
  Seen seen;
  const auto report =
      seen.look(flat_with([](int x, int y) { return std::abs(x - 3) <= 1 && std::abs(y - 5) <= 1 ? 0.4 : kGround; }));
  EXPECT_EQ(report.points_unsupported, 0U);
  EXPECT_FLOAT_EQ(seen.height_m(3, 5), 0.4F);
}

TEST(GroundGate, AWallOneCellWideIsGround) {
  Seen seen;
  const auto report = seen.look(flat_with([](int x, int) { return x == 3 ? 0.9 : kGround; }));
  EXPECT_EQ(report.points_unsupported, 0U);
  EXPECT_FLOAT_EQ(seen.height_m(3, 5), 0.9F);
}

TEST(GroundGate, AThinPostThatIsWellSeenIsGround) {
  Seen seen;
  PointFrame frame = flat_with([](int, int) { return kGround; });
  for (int i = 0; i < 8; ++i) test::add_point(frame, 2.55, 0.05, 0.5, 0.01);  // outside what lies flat
  for (int y = -2; y < 3; ++y)
    for (int x = 22; x < 29; ++x)
      if (x != 25 || y != 0) test::add_point(frame, 0.1 * x + 0.05, 0.1 * y + 0.05, 0.0, 0.01);
  EXPECT_EQ(seen.look(frame).points_unsupported, 0U);
  EXPECT_FLOAT_EQ(seen.height_m(25, 0), 0.5F);
}

TEST(GroundGate, WhatStaysForThreeFramesIsReal) {
  Seen seen;
  for (int i = 1; i < kFramesToReplace; ++i) {
    seen.look(flat_with([](int x, int y) { return x == 3 && y == 5 ? 0.6 : kGround; }));
    EXPECT_TRUE(std::isnan(seen.height_m(3, 5))) << i;
  }
  seen.look(flat_with([](int x, int y) { return x == 3 && y == 5 ? 0.6 : kGround; }));
  EXPECT_FLOAT_EQ(seen.height_m(3, 5), 0.6F);
}

TEST(GroundGate, FewNeighboursPredictNothing) {
  Seen seen;
  PointFrame frame = test::empty_frame({0, 0, 2});
  test::add_point(frame, 1.05, 1.05, 0.7, 0.01);
  test::add_point(frame, 1.15, 1.05, 0.0, 0.01);
  EXPECT_EQ(seen.look(frame).points_unsupported, 0U);
}

// One return a cell, normal heights of fBm-like change: |z − median| > 4 s has a chance of 6e-5 for normal z, fewer
// with the default law's 0.063 m at one cell against 0.02 m here. 1,600 cells: none, with probability above 0.99.
TEST(GroundGate, RoughGroundLosesNothing) {
  Seen seen;
  const auto report = seen.look(flat_with([](int x, int y) { return 0.02 * random_normals(9, 1, x, y)[0]; }));
  EXPECT_EQ(report.points_unsupported, 0U);
}

}  // namespace
}  // namespace scree::mapping
