#include "mapping/mapper.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <gtest/gtest.h>

#include "tests/mapping/range_scene.hpp"

namespace scree::mapping {
namespace {

double rolling_ground(double x_m, double y_m) {
  return 0.08 * std::sin(1.3 * x_m) * std::cos(0.9 * y_m) + 0.05 * std::sin(4.1 * x_m + y_m);
}

MapConfig small_map() {
  MapConfig config;
  config.size_cells = 100;
  return config;
}

/// Eight frames along a straight line, 0.4 m apart, the robot moving during each.
std::vector<RangeFrame> drive(const test::Height& ground, int frames = 8) {
  const test::SphericalScanner scanner;
  std::vector<RangeFrame> out;
  for (int i = 0; i < frames; ++i)
    out.push_back(scanner.frame(ground, test::at(0.4 * i, 0.1 * i), test::at(0.4 * i + 0.3, 0.1 * i), i));
  return out;
}

template <class T>
void expect_same_bits(const Grid<T>& a, const Grid<T>& b, const char* layer) {
  ASSERT_EQ(a.size(), b.size()) << layer;
  EXPECT_EQ(std::memcmp(a.data(), b.data(), a.size() * sizeof(T)), 0) << layer;
}

void expect_same_map(const MapSnapshot& a, const MapSnapshot& b) {
  EXPECT_EQ(a.window, b.window);
  expect_same_bits(a.cost, b.cost, "cost");
  expect_same_bits(a.state, b.state, "state");
  expect_same_bits(a.elevation_m, b.elevation_m, "elevation");
  expect_same_bits(a.elevation_mean_m, b.elevation_mean_m, "elevation mean");
  expect_same_bits(a.elevation_sigma_m, b.elevation_sigma_m, "elevation sigma");
  ASSERT_EQ(a.draws_m.size(), b.draws_m.size());
  for (std::size_t k = 0; k < a.draws_m.size(); ++k) expect_same_bits(a.draws_m[k], b.draws_m[k], "draw");
  expect_same_bits(a.risk, b.risk, "risk");
  expect_same_bits(a.cell_age_s, b.cell_age_s, "cell age");
  expect_same_bits(a.dimension_radius_cells, b.dimension_radius_cells, "radius of D");
  expect_same_bits(a.dimension, b.dimension, "dimension");
  expect_same_bits(a.dimension_sigma, b.dimension_sigma, "dimension sigma");
  expect_same_bits(a.dimension_flags, b.dimension_flags, "dimension flags");
  expect_same_bits(a.amplitude_m, b.amplitude_m, "amplitude");
  expect_same_bits(a.slope_rad, b.slope_rad, "slope");
  expect_same_bits(a.step_m, b.step_m, "step");
  expect_same_bits(a.hits, b.hits, "hits");
}

TEST(Mapper, HasNoSnapshotBeforeTheFirstFrame) {
  SerialExecutor serial;
  EXPECT_EQ(Mapper(small_map(), serial).snapshot(), nullptr);
}

TEST(Mapper, FlatPlaneIsMeasuredFlat) {
  SerialExecutor serial;
  Mapper mapper(small_map(), serial);
  for (const RangeFrame& frame : drive([](double, double) { return 0.25; })) ASSERT_TRUE(mapper.step(frame));
  const auto map = mapper.snapshot();
  ASSERT_GT(map->measured_cells(), 500U);
  EXPECT_GT(std::count(map->state.begin(), map->state.end(), CellState::reconstructed), 50);
  for (std::size_t i = 0; i < map->state.size(); ++i) {
    if (map->state[i] == CellState::reconstructed) {
      EXPECT_NEAR(map->elevation_m[i], 0.25F, 0.01F);
    }
    if (map->state[i] != CellState::measured) continue;
    EXPECT_NEAR(map->elevation_m[i], 0.25F, 1e-3F);
    EXPECT_GT(map->hits[i], 0);
    EXPECT_GT(map->elevation_sigma_m[i], 0.0F);
    if (std::isfinite(map->slope_rad[i])) {
      EXPECT_LT(map->slope_rad[i], 0.01F);
    }
  }
}

// Ground 1 : 5 along x: a cell's returns lie up to half a cell off its centre (0.01 m of height), and by as much as
// that moves the mean of a frame's innovations, some 2 mm, frames may be aligned.
TEST(Mapper, TiltedPlaneHasItsSlope) {
  SerialExecutor serial;
  Mapper mapper(small_map(), serial);
  for (const RangeFrame& frame : drive([](double x, double) { return 0.2 * (x - 3.0); }))
    ASSERT_TRUE(mapper.step(frame));
  const auto map = mapper.snapshot();
  double sum = 0.0;
  int cells = 0;
  for (int row = 0; row < map->state.rows(); ++row)
    for (int column = 0; column < map->state.columns(); ++column) {
      if (map->state(row, column) != CellState::measured) continue;
      const double x_m = (map->window.min.x + column + 0.5) * map->cell_m;
      EXPECT_NEAR(static_cast<double>(map->elevation_m(row, column)), 0.2 * (x_m - 3.0), 0.016);
      if (!std::isfinite(map->slope_rad(row, column))) continue;
      sum += static_cast<double>(map->slope_rad(row, column));
      ++cells;
    }
  ASSERT_GT(cells, 300);
  EXPECT_NEAR(sum / cells, std::atan(0.2), 0.01);
}

TEST(Mapper, EveryLayerIsTheSameForAnyExecutorAndAnyNumberOfSnapshots) {
  const auto frames = drive(rolling_ground);
  SerialExecutor serial;
  test::ReversedRanges two(2);
  test::ReversedRanges seven(7);
  test::ThreadedRanges threads(3);
  Mapper reference(small_map(), serial);
  Mapper others[3] = {{small_map(), two}, {small_map(), seven}, {small_map(), threads}};
  for (const RangeFrame& frame : frames) {
    ASSERT_TRUE(reference.step(frame));
    for (Mapper& other : others) ASSERT_TRUE(other.step(frame));
    const auto looked_at = others[0].snapshot();  // only this one is asked for every map
  }
  for (Mapper& other : others) expect_same_map(*reference.snapshot(), *other.snapshot());
}

TEST(Mapper, EveryPointIsCountedOnce) {
  SerialExecutor serial;
  Mapper mapper(small_map(), serial);
  for (const RangeFrame& frame : drive(rolling_ground)) {
    const auto report = mapper.step(frame);
    ASSERT_TRUE(report);
    EXPECT_GT(report->points_fused, 0U);
    EXPECT_EQ(report->counts.points,
              report->points_fused + report->points_outside + report->points_outlier + report->points_other_surface);
    EXPECT_EQ(report->counts.pixels,
              static_cast<std::uint64_t>(test::SphericalScanner::kRows * test::SphericalScanner::kColumns));
  }
}

// The window rolls 3 m and back: what is inside it must be what a window big enough never to roll holds.
TEST(Mapper, RollingLeavesNoStaleCells) {
  const test::SphericalScanner scanner;
  SerialExecutor serial;
  MapConfig big_config = small_map();
  big_config.size_cells = 400;
  Mapper rolling(small_map(), serial);
  Mapper big(big_config, serial);
  for (int i = 0; i < 6; ++i) {
    const RangeFrame frame = scanner.frame(rolling_ground, test::at(1.1 * i, -0.7 * i), test::at(1.1 * i, -0.7 * i), i);
    ASSERT_TRUE(rolling.step(frame));
    ASSERT_TRUE(big.step(frame));
  }
  const auto a = rolling.snapshot();
  const auto b = big.snapshot();
  int compared = 0, gated = 0;
  for (int row = 0; row < a->state.rows(); ++row)
    for (int column = 0; column < a->state.columns(); ++column) {
      const int other_row = a->window.min.y + row - b->window.min.y;
      const int other_column = a->window.min.x + column - b->window.min.x;
      if (a->state(row, column) != CellState::measured) continue;
      ASSERT_TRUE(b->state.contains(other_row, other_column));
      // The gate for lone returns goes by the roughness around, of which the larger window may have seen more.
      if (b->state(other_row, other_column) != CellState::measured) {
        ++gated;
        continue;
      }
      // Cells that the small window lost on the way were measured anew: fewer returns, never others.
      EXPECT_LE(a->hits(row, column), b->hits(other_row, other_column));
      EXPECT_NEAR(a->elevation_m(row, column), b->elevation_m(other_row, other_column), 0.05F);
      ++compared;
    }
  EXPECT_GT(compared, 500);
  EXPECT_LE(gated, compared / 200);
}

TEST(Mapper, SnapshotsNeverChangeOnceHandedOut) {
  SerialExecutor serial;
  Mapper mapper(small_map(), serial);
  const auto frames = drive(rolling_ground);
  ASSERT_TRUE(mapper.step(frames[0]));
  const auto held = mapper.snapshot();
  const MapSnapshot copy = *held;
  for (std::size_t i = 1; i < frames.size(); ++i) ASSERT_TRUE(mapper.step(frames[i]));
  expect_same_map(*held, copy);
  EXPECT_EQ(held->revision, 1U);
  EXPECT_EQ(mapper.snapshot()->revision, frames.size());
}

TEST(Mapper, AFrameWithoutReturnsLeavesAMapOfUnknowns) {
  SerialExecutor serial;
  Mapper mapper(small_map(), serial);
  const test::SphericalScanner scanner;
  ASSERT_TRUE(mapper.step(scanner.frame([](double, double) { return -100.0; }, test::at(0, 0), test::at(0, 0))));
  const auto map = mapper.snapshot();
  for (const CellState state : map->state) EXPECT_EQ(state, CellState::never_seen);
  for (const std::uint8_t cost : map->cost) EXPECT_EQ(cost, kCostUnknown);
  for (const float z : map->elevation_m) EXPECT_TRUE(std::isnan(z));
}

TEST(Mapper, ABadFrameIsAnErrorAndChangesNothing) {
  SerialExecutor serial;
  Mapper mapper(small_map(), serial);
  const auto frames = drive(rolling_ground, 2);
  ASSERT_TRUE(mapper.step(frames[0]));
  const auto before = mapper.snapshot();
  RangeFrame lost = frames[1];
  lost.T_map_body.back().translation_m.x() = std::nan("");
  RangeFrame far = frames[1];
  far.T_map_body.back().translation_m.x() = 1e15;
  RangeFrame short_frame = frames[1];
  short_frame.row_time.pop_back();
  for (const RangeFrame& bad : {lost, far, short_frame}) {
    const auto report = mapper.step(bad);
    ASSERT_FALSE(report);
    EXPECT_EQ(report.error().kind, ErrorKind::bad_data);
    EXPECT_EQ(mapper.snapshot(), before);
  }
}

TEST(Mapper, TheWindowStaysOnAStandingRobotThatJitters) {
  SerialExecutor serial;
  Mapper mapper(small_map(), serial);
  const test::SphericalScanner scanner;
  std::optional<LatticeWindow> window;
  for (int i = 0; i < 6; ++i) {
    const Pose pose = test::at(i % 2 == 0 ? 0.01 : -0.01, 0.0);
    ASSERT_TRUE(mapper.step(scanner.frame(rolling_ground, pose, pose, i)));
    if (window) {
      EXPECT_EQ(mapper.snapshot()->window, *window);
    }
    window = mapper.snapshot()->window;
  }
}

TEST(Mapper, NothingIsMeasuredWhereNoReturnFell) {
  SerialExecutor serial;
  Mapper mapper(small_map(), serial);
  const test::SphericalScanner scanner;
  ASSERT_TRUE(mapper.step(scanner.frame(rolling_ground, test::at(0, 0), test::at(0, 0))));
  const auto map = mapper.snapshot();
  for (std::size_t i = 0; i < map->state.size(); ++i) {
    EXPECT_EQ(map->state[i] == CellState::measured, map->hits[i] > 0);
    const bool has_height = map->state[i] == CellState::measured || map->state[i] == CellState::reconstructed;
    EXPECT_EQ(std::isfinite(map->elevation_m[i]), has_height);
    if (!has_height) {
      EXPECT_GE(map->cost[i], kCostLethal);
    }
    if (map->state[i] == CellState::reconstructed) {
      EXPECT_GE(map->cost[i], 64);
    }
  }
}

}  // namespace
}  // namespace scree::mapping
