// Several heights in a cell, and things that come and go, end to end.

#include <cmath>
#include <gtest/gtest.h>

#include "mapping/mapper.hpp"
#include "mapping/visibility.hpp"
#include "tests/mapping/support.hpp"

namespace scree::mapping {
namespace {

MapConfig small_map() {
  MapConfig config;
  config.size_cells = 100;
  return config;
}

PointFrame view(const test::Height& ground, std::uint64_t frame) {
  PointFrame out = test::scan(ground, {0, 0, 1.5}, -0.5, 0.5, 160, -0.9, 0.05, 160, 15.0);
  for (float& variance : out.range_variance_m2) variance = 1e-4F;
  out.time = Time(std::chrono::milliseconds(100 * frame));
  return out;
}

double box(double x_m, double y_m) {
  return x_m > 3.0 && x_m < 3.6 && std::abs(y_m) < 0.4 ? 0.5 : 0.0;
}

struct Cells {
  int between = 0;  ///< measured at a height that is neither the ground nor the top
  int ground = 0, top = 0;
};

Cells cells_of(const MapSnapshot& map, float top_m) {
  Cells out;
  for (std::size_t i = 0; i < map.state.size(); ++i) {
    if (map.state[i] != CellState::measured) continue;
    const float z = map.elevation_m[i];
    out.ground += std::abs(z) < 0.05F ? 1 : 0;
    out.top += std::abs(z - top_m) < 0.05F ? 1 : 0;
    out.between += std::abs(z) >= 0.05F && std::abs(z - top_m) >= 0.05F ? 1 : 0;
  }
  return out;
}

// The face of the box (x = 3 m) is seen: its column of 8 cells holds returns of every height between, the only ground
// that is there. No other cell may.
TEST(Surfaces, ARocksEdgeIsGroundOrTopAndNothingBetween) {
  SerialExecutor serial;
  Mapper mapper(small_map(), serial);
  for (std::uint64_t i = 0; i < 5; ++i) ASSERT_TRUE(mapper.integrate(view(box, i)));
  const auto map = mapper.snapshot();
  const Cells cells = cells_of(*map, 0.5F);
  EXPECT_GT(cells.ground, 500);
  EXPECT_GT(cells.top, 20);
  for (int row = 0; row < map->state.rows(); ++row)
    for (int column = 0; column < map->state.columns(); ++column) {
      const int x = map->window.min.x + column;
      const float z = map->elevation_m(row, column);
      if (map->state(row, column) != CellState::measured || std::abs(x - 30) <= 1) continue;
      EXPECT_TRUE(std::abs(z) < 0.05F || std::abs(z - 0.5F) < 0.05F) << x << ' ' << z;
    }
}

// A slab 1.4 m above the ground, seen with the ground below it: 30 % of the returns of a cell and 70 %.
TEST(Surfaces, WhatIsUnderAnOverhangIsTheGround) {
  SerialExecutor serial;
  Mapper mapper(small_map(), serial);
  for (std::uint64_t frame = 0; frame < 5; ++frame) {
    PointFrame out = test::empty_frame({0, 0, 2});
    for (int i = 0; i < 30000; ++i) {
      const auto words = random_words(frame, 1, i, 0);
      const double x = 1.0 + 3.0 * to_uniform(words[0]), y = 3.0 * to_uniform(words[1]);
      const bool above = to_uniform(words[2]) < 0.7;
      test::add_point(out, x, y, (above ? 1.4 : 0.0) + 0.01 * random_normals(frame, 2, i, 0)[0], 0.01);
    }
    out.time = Time(std::chrono::milliseconds(100 * frame));
    const auto report = mapper.integrate(out);
    ASSERT_TRUE(report);
    EXPECT_EQ(report->points_fused + report->points_outlier + report->points_other_surface + report->points_outside,
              out.size());
  }
  const Cells cells = cells_of(*mapper.snapshot(), 1.4F);
  EXPECT_EQ(cells.between, 0);
  EXPECT_EQ(cells.top, 0);
  EXPECT_GT(cells.ground, 800);
}

// A box that stood for a second drives away: within kFramesToForget frames that see the ground behind it no cell
// holds its top. Cells that returns reach are replaced after kFramesToReplace of them.
TEST(Surfaces, ABoxThatDroveAwayIsClearedWithinFiveFrames) {
  SerialExecutor serial;
  Mapper mapper(small_map(), serial);
  std::uint64_t frame = 0;
  for (; frame < 10; ++frame) ASSERT_TRUE(mapper.integrate(view(box, frame)));
  ASSERT_GT(cells_of(*mapper.snapshot(), 0.5F).top, 20);
  const auto flat = [](double, double) { return 0.0; };
  for (int i = 0; i < kFramesToForget; ++i) ASSERT_TRUE(mapper.integrate(view(flat, frame++)));
  const auto map = mapper.snapshot();
  for (std::size_t i = 0; i < map->state.size(); ++i)
    if (map->state[i] == CellState::measured) {
      EXPECT_LT(std::abs(map->elevation_m[i]), 0.05F);
    }
}

// A box of 0.6 m that crosses the view at 1.5 m/s, 10 frames a second: it leaves no more behind than it covered during
// kFramesToForget frames.
TEST(Surfaces, AMovingBoxLeavesNoTrail) {
  SerialExecutor serial;
  Mapper mapper(small_map(), serial);
  for (std::uint64_t frame = 0; frame < 14; ++frame) {
    const double y0 = -1.2 + 0.15 * static_cast<double>(frame);
    const auto moving = [y0](double x, double y) { return x > 3.0 && x < 3.4 && y > y0 && y < y0 + 0.6 ? 0.5 : 0.0; };
    ASSERT_TRUE(mapper.integrate(view(moving, frame)));
  }
  const auto map = mapper.snapshot();
  const double y_now = -1.2 + 0.15 * 13, trail_m = 0.15 * kFramesToForget + 0.1;
  for (int row = 0; row < map->state.rows(); ++row)
    for (int column = 0; column < map->state.columns(); ++column) {
      const double y = (map->window.min.y + row + 0.5) * 0.1;
      if (map->state(row, column) == CellState::measured && y < y_now - trail_m) {
        EXPECT_LT(map->elevation_m(row, column), 0.05F) << column << ' ' << y;
      }
    }
}

TEST(Surfaces, CellsSayWhenTheyWereLastSeen) {
  SerialExecutor serial;
  Mapper mapper(small_map(), serial);
  const auto flat = [](double, double) { return 0.0; };
  ASSERT_TRUE(mapper.integrate(view(flat, 0)));
  PointFrame one = test::empty_frame({0, 0, 1.5F});
  test::add_point(one, 2.05, 0.05, 0.0, 0.01);
  one.time = Time(std::chrono::milliseconds(2500));
  ASSERT_TRUE(mapper.integrate(one));
  const auto map = mapper.snapshot();
  const int row = -map->window.min.y;
  EXPECT_FLOAT_EQ(map->cell_age_s(row, 20 - map->window.min.x), 0.0F);
  EXPECT_FLOAT_EQ(map->cell_age_s(row, 25 - map->window.min.x), 2.5F);
  for (std::size_t i = 0; i < map->state.size(); ++i)
    EXPECT_EQ(std::isfinite(map->cell_age_s[i]), map->state[i] == CellState::measured);
}

}  // namespace
}  // namespace scree::mapping
