#include "client/examples/path_planner.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <random>

namespace scree_example {
namespace {

CostGrid grid_of(int columns, int rows, std::uint8_t cost = 0) {
  CostGrid grid;
  grid.columns = columns;
  grid.rows = rows;
  grid.cell_m = 0.1;
  grid.x_min_m = -1.0;
  grid.y_min_m = -2.0;
  grid.cost.assign(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows), cost);
  return grid;
}

Point middle(const CostGrid& grid, int column, int row) {
  return grid.centre(grid.index(column, row));
}

TEST(PathPlanner, GoesStraightOverFreeGround) {
  const CostGrid grid = grid_of(60, 40);
  const Path path = PathPlanner().plan(grid, middle(grid, 5, 20), middle(grid, 45, 20));
  ASSERT_TRUE(path.found);
  EXPECT_NEAR(path.length_m, 4.0, 1e-9);
  EXPECT_NEAR(path.price_m, 4.0, 1e-9);
}

/// Bellman–Ford over the same steps: slow and plain.
double least_price(const CostGrid& grid, const PlanRules& rules, std::size_t from, std::size_t to) {
  const double none = std::numeric_limits<double>::infinity();
  const auto weight = [&](int c, int r) {
    const std::uint8_t cost = grid.cost[grid.index(c, r)];
    if (cost == kLethal) return none;
    return 1.0 + rules.cost_weight * (cost == kUnknown ? rules.unknown_cost : cost) / 252.0;
  };
  std::vector<double> price(grid.cost.size(), none);
  price[from] = 0.0;
  for (bool changed = true; changed;) {
    changed = false;
    for (int r = 0; r < grid.rows; ++r)
      for (int c = 0; c < grid.columns; ++c)
        for (int dr = -1; dr <= 1; ++dr)
          for (int dc = -1; dc <= 1; ++dc) {
            if (!grid.contains(c + dc, r + dr) || std::isinf(weight(c, r) + weight(c + dc, r + dr))) continue;
            if (dr != 0 && dc != 0 && std::isinf(weight(c + dc, r) + weight(c, r + dr))) continue;
            const double step = 0.1 * std::hypot(dr, dc);
            const double through = price[grid.index(c, r)] + 0.5 * step * (weight(c, r) + weight(c + dc, r + dr));
            double& best = price[grid.index(c + dc, r + dr)];
            if (through < best - 1e-12) {
              best = through;
              changed = true;
            }
          }
  }
  return price[to];
}

TEST(PathPlanner, FindsThePathThatNoOtherIsCheaperThan) {
  std::mt19937 random(5);
  PlanRules rules;
  rules.start_radius_m = 0.0;
  int found = 0;
  for (int trial = 0; trial < 60; ++trial) {
    CostGrid grid = grid_of(15, 12);
    for (std::uint8_t& cost : grid.cost)
      cost = static_cast<std::uint8_t>(random() % 4 == 0 ? 254 : random() % 6 == 0 ? 255 : random() % 253);
    const std::size_t from = grid.index(1, 1), to = grid.index(13, 10);
    grid.cost[from] = grid.cost[to] = 0;
    const Path path = PathPlanner(rules).plan(grid, grid.centre(from), grid.centre(to));
    const double least_m = least_price(grid, rules, from, to);
    ASSERT_EQ(path.found, std::isfinite(least_m));
    if (!path.found) continue;
    ++found;
    EXPECT_NEAR(path.price_m, least_m, 1e-9);
    for (const Point& p : path.points)
      EXPECT_NE(grid.cost[grid.index(grid.column_of(p.x_m), grid.row_of(p.y_m))], kLethal);
  }
  EXPECT_GT(found, 10);
}

TEST(PathPlanner, DoesNotSqueezeBetweenTwoForbiddenCorners) {
  CostGrid grid = grid_of(10, 10);
  for (int i = 0; i < 10; ++i) grid.cost[grid.index(i, 9 - i)] = kLethal;
  EXPECT_FALSE(PathPlanner().plan(grid, middle(grid, 1, 1), middle(grid, 8, 8)).found);
}

TEST(PathPlanner, EntersUnknownGroundOnlyWhereTheUserSaysSo) {
  CostGrid grid = grid_of(30, 10);
  for (int row = 0; row < 10; ++row) grid.cost[grid.index(15, row)] = kUnknown;
  PlanRules rules;
  EXPECT_TRUE(PathPlanner(rules).plan(grid, middle(grid, 2, 5), middle(grid, 27, 5)).found);
  rules.enter_unknown = false;
  EXPECT_FALSE(PathPlanner(rules).plan(grid, middle(grid, 2, 5), middle(grid, 27, 5)).found);
}

TEST(PathPlanner, LeavesTheLethalCellsItStandsOn) {
  CostGrid grid = grid_of(40, 40);
  for (int row = 17; row <= 23; ++row)
    for (int column = 17; column <= 23; ++column) grid.cost[grid.index(column, row)] = kLethal;
  EXPECT_TRUE(PathPlanner().plan(grid, middle(grid, 20, 20), middle(grid, 35, 20)).found);
  EXPECT_FALSE(PathPlanner().plan(grid, middle(grid, 35, 20), middle(grid, 20, 20)).found);
}

// Standing free beside a wall is no reason to drive over it.
TEST(PathPlanner, DoesNotCrossAThinLethalWallFromItsFoot) {
  CostGrid grid = grid_of(40, 20);
  for (int row = 0; row < 20; ++row)
    for (int column = 20; column < 23; ++column) grid.cost[grid.index(column, row)] = kLethal;
  EXPECT_FALSE(PathPlanner().plan(grid, middle(grid, 18, 10), middle(grid, 30, 10)).found);
}

TEST(PathPlanner, HasNoPathBeyondTheGrid) {
  const CostGrid grid = grid_of(10, 10);
  EXPECT_FALSE(PathPlanner().plan(grid, middle(grid, 5, 5), {100.0, 0.0}).found);
}

/// The vehicle goes as it is told, 50 times a second.
Posture drive_along(const Path& path, Posture posture, const FollowRules& rules, double* worst_aside_m) {
  *worst_aside_m = 0.0;
  for (int step = 0; step < 50 * 60; ++step) {
    const Drive drive = follow(path, posture, rules);
    if (drive.speed_mps == 0.0) break;
    const double way_m = drive.speed_mps / 50.0;
    posture.heading_rad += way_m * drive.curvature_per_m;
    posture.at.x_m += way_m * std::cos(posture.heading_rad);
    posture.at.y_m += way_m * std::sin(posture.heading_rad);
    double aside_m = 1e9;
    for (const Point& p : path.points) aside_m = std::min(aside_m, distance_m(p, posture.at));
    *worst_aside_m = std::max(*worst_aside_m, aside_m);
  }
  return posture;
}

// On a square's sides the arc through a point look_ahead_m ahead cuts the corner by at most that.
TEST(Follow, KeepsToThePathAndStopsAtItsEnd) {
  Path path;
  path.found = true;
  for (int i = 0; i <= 50; ++i) path.points.push_back({0.1 * i, 0.0});
  for (int i = 1; i <= 50; ++i) path.points.push_back({5.0, 0.1 * i});
  double aside_m = 0.0;
  const FollowRules rules;
  const Posture end = drive_along(path, {{0.0, 0.0}, 0.0}, rules, &aside_m);
  EXPECT_LE(distance_m(end.at, {5.0, 5.0}), rules.goal_radius_m);
  EXPECT_LT(aside_m, rules.look_ahead_m);
}

// Whatever the goal's place in its cell and the side it is reached from.
TEST(Follow, ArrivesWithinTheGoalRadiusOfTheGoalItself) {
  const CostGrid grid = grid_of(80, 80);
  std::mt19937 random(3);
  const auto uniform = [&](double from, double to) {
    return from + (to - from) * static_cast<double>(random()) / 4294967296.0;
  };
  const FollowRules rules;
  for (int trial = 0; trial < 200; ++trial) {
    const Point goal{uniform(2.0, 4.0), uniform(1.0, 3.0)}, start{uniform(-0.5, 1.0), uniform(-1.0, 5.0)};
    const Path path = PathPlanner().plan(grid, start, goal);
    ASSERT_TRUE(path.found);
    double aside_m = 0.0;
    const Posture end = drive_along(path, {start, uniform(-3.0, 3.0)}, rules, &aside_m);
    EXPECT_LE(distance_m(end.at, goal), rules.goal_radius_m) << trial;
  }
}

TEST(Follow, TurnsRoundWhenThePathLeadsBackwards) {
  Path path;
  path.found = true;
  for (int i = 0; i <= 60; ++i) path.points.push_back({-0.1 * i, 0.0});
  double aside_m = 0.0;
  const FollowRules rules;
  const Posture end = drive_along(path, {{0.0, 0.0}, 0.0}, rules, &aside_m);
  EXPECT_LE(distance_m(end.at, {-6.0, 0.0}), rules.goal_radius_m);
  EXPECT_LT(aside_m, 2.0 / rules.max_curvature_per_m + rules.look_ahead_m);
}

TEST(Follow, StandsStillWithoutAPath) {
  EXPECT_EQ(follow({}, {}, {}).speed_mps, 0.0);
}

}  // namespace
}  // namespace scree_example
