#include "mapping/alignment.hpp"

#include <cmath>
#include <gtest/gtest.h>

#include "core/random.hpp"
#include "mapping/mapper.hpp"
#include "tests/mapping/range_scene.hpp"
#include "tests/mapping/support.hpp"

namespace scree::mapping {
namespace {

double rough_ground(double x_m, double y_m) {
  return 0.05 * std::sin(1.3 * x_m) * std::cos(0.9 * y_m) + 0.03 * std::sin(4.1 * x_m + y_m);
}

/// Returns of the ground all around, 12 m wide, 2 cm of range noise, heights off by `plane`.
PointFrame look(std::uint64_t seed, const HeightPlane& plane, const test::Height& ground = rough_ground) {
  PointFrame frame = test::empty_frame({0, 0, 2});
  for (int i = 0; i < 20000; ++i) {
    const auto words = random_words(seed, 3, i, 0);
    const double x = 6.0 - 12.0 * to_uniform(words[0]), y = 6.0 - 12.0 * to_uniform(words[1]);
    const double z = ground(x, y) + plane.at(x, y) + 0.01 * random_normals(seed, 4, i, 0)[0];
    test::add_point(frame, x, y, z, 0.02);
  }
  frame.time = Time(std::chrono::milliseconds(100 * seed));
  return frame;
}

MapConfig small_map() {
  MapConfig config;
  config.size_cells = 100;
  return config;
}

HeightPlane plane_of(double height_m, double slope_x, double slope_y) {
  HeightPlane plane;
  plane.height_m = height_m;
  plane.slope = {slope_x, slope_y};
  return plane;
}

float steepest_step_m(const MapSnapshot& map) {
  float step = 0.0F;
  for (std::size_t i = 0; i < map.step_m.size(); ++i)
    if (std::isfinite(map.step_m[i])) step = std::max(step, map.step_m[i]);
  return step;
}

// 100 × 100 cells of two returns each: the plane's height is known to well below 1 mm, its slope to 0.2 mrad; 2 mm and
// 1 mrad leave room for the share that is left to views.
TEST(Alignment, FindsHeightAndTiltOfAFrame) {
  SerialExecutor serial;
  Mapper mapper(small_map(), serial);
  ASSERT_TRUE(mapper.integrate(look(1, {})));
  const auto report = mapper.integrate(look(2, plane_of(0.04, 0.012, -0.009)));
  ASSERT_TRUE(report);
  EXPECT_EQ(report->alignment.agreement, Agreement::registered);
  EXPECT_NEAR(report->alignment.height_m, 0.04, 2e-3);
  EXPECT_NEAR(report->alignment.tilt_rad, 0.015, 1e-3);
}

TEST(Alignment, TheMapFollowsThePoseInHeight) {
  SerialExecutor serial;
  Mapper mapper(small_map(), serial);
  for (std::uint64_t i = 1; i <= 20; ++i)
    ASSERT_TRUE(mapper.integrate(look(i, plane_of(0.02 * static_cast<double>(i), 0.0, 0.0))));
  const auto map = mapper.snapshot();
  double sum = 0.0, count = 0.0;
  for (int row = 0; row < 100; ++row)
    for (int column = 0; column < 100; ++column) {
      const double x_m = (map->window.min.x + column + 0.5) * 0.1, y_m = (map->window.min.y + row + 0.5) * 0.1;
      sum += static_cast<double>(map->elevation_m(row, column)) - rough_ground(x_m, y_m);
      count += 1.0;
    }
  EXPECT_NEAR(sum / count, 0.4, 5e-3);
}

// All of the view, then a quarter of it 38 times: what is out of sight moves with the rest only where a disagreement is
// significant. Here there is none: views differ by their noise alone.
TEST(Alignment, GroundOutOfSightDoesNotSink) {
  SerialExecutor serial;
  Mapper mapper(small_map(), serial);
  ASSERT_TRUE(mapper.integrate(look(1, {})));
  const auto near = [](PointFrame frame) {
    PointFrame out = test::empty_frame({0, 0, 2});
    out.time = frame.time;
    for (std::size_t i = 0; i < frame.size(); ++i)
      if (frame.x_m[i] > 0.0F && frame.y_m[i] > 0.0F)
        test::add_point(out, static_cast<double>(frame.x_m[i]), static_cast<double>(frame.y_m[i]),
                        static_cast<double>(frame.z_m[i]), 0.02);
    return out;
  };
  const float before = mapper.snapshot()->elevation_m(20, 20);
  for (std::uint64_t i = 2; i < 20; ++i) ASSERT_TRUE(mapper.integrate(near(look(i, {}))));
  const float settled = mapper.snapshot()->elevation_m(20, 20);
  EXPECT_NEAR(settled, before, 2e-3F);  // the tilt of one frame's noise over 2 m, until more frames outweigh it
  for (std::uint64_t i = 20; i < 40; ++i) ASSERT_TRUE(mapper.integrate(near(look(i, {}))));
  // not measured, so a draw: what the solver's tolerance leaves of it moves with what is measured elsewhere
  EXPECT_NEAR(mapper.snapshot()->elevation_m(20, 20), settled, 1e-4F);
}

TEST(Alignment, AJumpInHeightIsCountedAndMakesNoWalls) {
  SerialExecutor serial;
  Mapper mapper(small_map(), serial);
  for (std::uint64_t i = 1; i <= 3; ++i) ASSERT_TRUE(mapper.integrate(look(i, {})));
  const float before_m = steepest_step_m(*mapper.snapshot());
  const auto report = mapper.integrate(look(4, plane_of(0.8, 0.02, 0.0)));
  ASSERT_TRUE(report);
  EXPECT_EQ(report->alignment.agreement, Agreement::jumped);
  EXPECT_LT(steepest_step_m(*mapper.snapshot()), before_m + 0.02F);
  EXPECT_NEAR(mapper.snapshot()->elevation_m(50, 50), 0.8, 0.1);
}

// Ground that is a metre off, this way here and that way there: the pose is somewhere else altogether.
TEST(Alignment, AFrameThatContradictsTheWholeMapIsRefusedAndTheSecondBeginsANewMap) {
  const test::Height elsewhere = [](double x_m, double y_m) {
    return std::sin(0.8 * x_m) * std::sin(0.8 * y_m) > 0.0 ? 1.0 : -1.0;
  };
  SerialExecutor serial;
  Mapper mapper(small_map(), serial);
  for (std::uint64_t i = 1; i <= 3; ++i) ASSERT_TRUE(mapper.integrate(look(i, {})));
  const float before = mapper.snapshot()->elevation_m(50, 50);
  auto report = mapper.integrate(look(4, {}, elsewhere));
  ASSERT_TRUE(report);
  EXPECT_TRUE(report->alignment.refused);
  EXPECT_EQ(report->points_fused, 0U);
  EXPECT_EQ(report->points_outlier + report->points_outside, 20000U);
  EXPECT_FLOAT_EQ(mapper.snapshot()->elevation_m(50, 50), before);
  report = mapper.integrate(look(5, {}, elsewhere));
  ASSERT_TRUE(report);
  EXPECT_TRUE(report->alignment.forgotten);
  const auto map = mapper.snapshot();
  int wrong = 0;
  for (std::size_t i = 0; i < map->state.size(); ++i)
    wrong += map->state[i] == CellState::measured && std::abs(std::abs(map->elevation_m[i]) - 1.0F) > 0.1F ? 1 : 0;
  EXPECT_EQ(wrong, 0);
}

TEST(Alignment, WithoutOverlapAFrameIsTakenAsItIs) {
  SerialExecutor serial;
  Mapper mapper(small_map(), serial);
  const auto report = mapper.integrate(look(1, plane_of(0.3, 0.01, 0.0)));
  ASSERT_TRUE(report);
  EXPECT_EQ(report->alignment.agreement, Agreement::unknown);
  EXPECT_EQ(report->alignment.overlap, 0U);
  EXPECT_NEAR(mapper.snapshot()->elevation_m(50, 50), 0.3, 0.1);
}

// A quarter of the overlap is a box that was not there: it lifts nothing else.
TEST(Alignment, AnObjectThatCameDoesNotMoveTheMap) {
  const test::Height with_box = [](double x_m, double y_m) {
    return x_m > 0.0 && y_m > 0.0 ? 1.5 : rough_ground(x_m, y_m);
  };
  SerialExecutor serial;
  Mapper mapper(small_map(), serial);
  for (std::uint64_t i = 1; i <= 3; ++i) ASSERT_TRUE(mapper.integrate(look(i, {})));
  const auto report = mapper.integrate(look(4, {}, with_box));
  ASSERT_TRUE(report);
  EXPECT_EQ(report->alignment.agreement, Agreement::registered);
  EXPECT_NEAR(report->alignment.height_m, 0.0, 4e-3);
}

// Variances that a pose source states are the frame's own: at 5 m, 0.1 m and 0.02 rad make √(0.1² + (0.02 · 5)²) m.
TEST(Alignment, ThePosesVarianceIsInTheCells) {
  SerialExecutor serial;
  Mapper mapper(small_map(), serial);
  PointFrame frame = look(1, {});
  frame.pose_variance.position_m2.z() = 0.01;
  frame.pose_variance.attitude_rad2.setConstant(0.0004);
  ASSERT_TRUE(mapper.integrate(frame));
  const auto map = mapper.snapshot();
  const auto sigma_near = [&](int column) {  // five rows: some of them were hit
    for (int row = 48; row < 53; ++row)
      if (map->state(row, column) == CellState::measured) return map->elevation_sigma_m(row, column);
    return 0.0F;
  };
  EXPECT_NEAR(sigma_near(99), 0.1412, 0.01);
  EXPECT_NEAR(sigma_near(50), 0.1, 0.01);
}

// The pose drifts 2 cm a frame along x, so the frames lie beside the map by as much; the ground has slopes of some 0.1
// everywhere. 6 mm are left alone by design, and 4 mm more cover the error of one fit (some 400 cells, 1 cm of noise).
TEST(Alignment, FramesThatDriftSidewaysArePlacedBackAndTheMapFollows) {
  SerialExecutor serial;
  Mapper mapper(small_map(), serial);
  double worst_m = 0.0;
  for (std::uint64_t i = 0; i < 20; ++i) {
    const double drift_m = 0.02 * static_cast<double>(i);
    const test::Height drifted = [drift_m](double x_m, double y_m) { return rough_ground(x_m - drift_m, y_m); };
    const auto report = mapper.integrate(look(i + 1, {}, drifted));
    ASSERT_TRUE(report);
    EXPECT_LE(std::abs(report->alignment.beside.x_m), 0.075);  // half a cell, a step, and its error
  }
  const auto map = mapper.snapshot();
  for (int row = 10; row < 90; ++row)
    for (int column = 10; column < 90; ++column) {
      const double x_m = (map->window.min.x + column + 0.5) * 0.1, y_m = (map->window.min.y + row + 0.5) * 0.1;
      const double error_m = static_cast<double>(map->elevation_m(row, column)) - rough_ground(x_m - 0.38, y_m);
      worst_m = std::max(worst_m, std::abs(error_m));
    }
  // slopes up to 0.2 times half a cell and what is left, and 4 sigma of a cell's noise and places
  EXPECT_LT(worst_m, 0.2 * 0.06 + 0.03);
}

}  // namespace
}  // namespace scree::mapping
