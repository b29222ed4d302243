// What must not be missed, and what must not be invented, end to end: frames in, costs out.

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

#include "mapping/fusion.hpp"
#include "mapping/mapper.hpp"
#include "tests/mapping/support.hpp"

namespace scree::mapping {
namespace {

MapConfig map_of(int size_cells) {
  MapConfig config;
  config.size_cells = size_cells;
  return config;
}

/// Some millimetres of relief, so that the ground has a law.
double floor_m(double x, double y) {
  return 0.004 * std::sin(20.0 * x + 3.0 * y) * std::cos(17.0 * y);
}

PointFrame stamped(PointFrame frame, int number) {
  for (float& variance : frame.range_variance_m2) variance = 1e-4F;
  frame.time = Time(std::chrono::milliseconds(100 * number));
  return frame;
}

/// A dense scanner 1.5 m above the origin that looks along +x.
PointFrame view(const test::Height& ground, int number) {
  return stamped(test::scan(ground, {0, 0, 1.5}, -0.5, 0.5, 260, -0.9, 0.05, 160, 20.0), number);
}

struct Window {
  std::shared_ptr<const MapSnapshot> map;
  explicit Window(Mapper& mapper) : map(mapper.snapshot()) {}
  template <class Value>
  Value at(const Grid<Value>& grid, double x_m, double y_m) const {
    const CellIndex cell = lattice_cell(x_m, y_m, 0.1);
    return grid(cell.y - map->window.min.y, cell.x - map->window.min.x);
  }
  int cost(double x_m, double y_m) const { return at(map->cost, x_m, y_m); }
};

TEST(Obstacles, APostIsLethalOnItsOwnCellAndAround) {
  SerialExecutor serial;
  for (const double height_m : {0.4, 0.9, 1.8})
    for (const double radius_m : {0.06, 0.12}) {
      Mapper mapper(map_of(120), serial);
      for (int n = 0; n < 10; ++n)
        ASSERT_TRUE(mapper.integrate(view(
            [&](double x, double y) { return std::hypot(x - 3.05, y - 0.05) < radius_m ? height_m : floor_m(x, y); },
            n)));
      const Window window(mapper);
      for (double x = 2.85; x < 3.0; x += 0.1)  // before it and on the side that is seen
        for (double y = -0.05; y < 0.2; y += 0.1)
          EXPECT_EQ(window.cost(x, y), kCostLethal) << height_m << ' ' << radius_m << ' ' << x << ' ' << y;
    }
}

// Between the rings of 16 rows a person's returns lie apart like surfaces of their own: no overhang.
TEST(Obstacles, APersonBetweenSparseRingsIsNoOverhang) {
  SerialExecutor serial;
  constexpr double kDegree = std::numbers::pi / 180.0;
  for (const double away_m : {6.2, 7.1}) {
    Mapper mapper(map_of(200), serial);
    const auto look = [&](const test::Height& ground, int number) {
      return stamped(test::scan(ground, {0, 0, 1.5}, -0.4, 0.4, 200, -16.0 * kDegree, 16.0 * kDegree, 16, 20.0),
                     number);
    };
    for (int n = 0; n < 10; ++n) ASSERT_TRUE(mapper.integrate(look(floor_m, n)));
    const test::Height person = [&](double x, double y) {
      return std::hypot(x - away_m, y - 0.05) < 0.2 ? 1.8 : floor_m(x, y);
    };
    for (int n = 10; n < 22; ++n) ASSERT_TRUE(mapper.integrate(look(person, n)));
    const Window window(mapper);
    for (double y = -0.05; y < 0.2; y += 0.1)
      EXPECT_EQ(window.cost(away_m - 0.15, y), kCostLethal) << away_m << ' ' << y;
  }
}

TEST(Obstacles, NoWheelStandsBeyondTheRimOfACliffForFree) {
  SerialExecutor serial;
  Mapper mapper(map_of(120), serial);
  for (int n = 0; n < 10; ++n)
    ASSERT_TRUE(mapper.integrate(view([](double x, double y) { return x > 4.0 ? -3.0 : floor_m(x, y); }, n)));
  const Window window(mapper);
  EXPECT_GE(window.cost(3.95, 0.05), 64);
  EXPECT_GE(window.cost(3.85, 0.05), 64);
  EXPECT_LT(window.cost(2.55, 0.05), 64);
}

/// A crown at (4.05, 0.05), 3 m up, and rays over ground beyond it where `below` is set.
PointFrame crown(bool below, int number) {
  PointFrame frame = test::empty_frame({0, 0, 1.5});
  for (int row = -40; row <= 40; ++row)
    for (int column = 5; column < (below ? 58 : 38); ++column)
      if (std::abs(column - 40) > 3 || std::abs(row) > 3)
        test::add_point(frame, 0.1 * column + 0.05, 0.1 * row + 0.05, 0.0);
  for (int i = 0; i < 20; ++i) test::add_point(frame, 4.01 + 0.004 * i, 0.05, 3.0);
  return stamped(frame, number);
}

TEST(Obstacles, ACrownIsForgottenOnceRaysPassBelowIt) {
  SerialExecutor serial;
  Mapper mapper(map_of(120), serial);
  ASSERT_TRUE(mapper.integrate(crown(false, 0)));
  for (int n = 1; n < 4; ++n) ASSERT_TRUE(mapper.integrate(crown(false, n)));
  ASSERT_NEAR(Window(mapper).at(mapper.snapshot()->elevation_m, 4.05, 0.05), 3.0F, 0.1F);
  // two frames until the ceiling is in force, and kFramesToForget
  for (int n = 4; n < 6 + kFramesToForget; ++n) ASSERT_TRUE(mapper.integrate(crown(true, n)));
  EXPECT_NE(Window(mapper).at(mapper.snapshot()->state, 4.05, 0.05), CellState::measured);
}

TEST(Obstacles, OneStrayReturnBelowTheGroundBlindsNothing) {
  SerialExecutor serial;
  Mapper mapper(map_of(220), serial);
  const auto far = [](int number) {
    return stamped(test::scan(floor_m, {0, 0, 1.5}, -0.5, 0.5, 260, -0.9, 0.05, 160, 20.0), number);
  };
  PointFrame first = far(0);
  test::add_point(first, 9.9, 0.0, -4.0, 0.01);
  ASSERT_TRUE(mapper.integrate(first));
  for (int n = 1; n < 8; ++n) ASSERT_TRUE(mapper.integrate(far(n)));
  const Window window(mapper);
  for (double x = 5.05; x < 9.7; x += 0.1)
    EXPECT_NE(window.at(window.map->state, x, 0.05), CellState::possible_drop) << x;
  EXPECT_EQ(window.at(window.map->state, 5.05, 0.05), CellState::measured);
}

}  // namespace
}  // namespace scree::mapping
