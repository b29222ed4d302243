#include "mapping/visibility.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

#include "mapping/cell_states.hpp"
#include "mapping/fusion.hpp"
#include "tests/mapping/support.hpp"

namespace scree::mapping {
namespace {

constexpr double kCell_m = 0.1;

/// Map of a scanner 1.5 m above the map's origin that looks along +x through `azimuth_half` either side.
class Scene {
 public:
  explicit Scene(int size_cells = 200) : map_(size_cells, size_cells, {}), visibility_(config(size_cells)) {
    map_.roll_to({-size_cells / 2, -size_cells / 2});
  }
  static VisibilityConfig config(int size_cells) {
    VisibilityConfig config;
    config.cell_m = kCell_m;
    config.size_cells = size_cells;
    return config;
  }
  void look(const PointFrame& frame, Executor& executor) {
    points_.sort(frame, map_.window(), kCell_m, executor);
    returns_.gather(frame, {}, points_, map_, GroundConfig{}, executor);
    visibility_.update(frame, points_, {}, executor, map_);
    fusion_.fuse(returns_, 0, GateLaw(), executor, map_);
  }
  void look(const test::Height& ground, double azimuth_half = 0.5, int azimuths = 220, int elevations = 200) {
    SerialExecutor serial;
    look(test::scan(ground, {0, 0, 1.5}, -azimuth_half, azimuth_half, azimuths, -0.9, 0.05, elevations, 25.0), serial);
  }
  /// States without a reconstruction, or with flat ground at `filled_m`.
  Grid<CellState> states(float filled_m = std::numeric_limits<float>::quiet_NaN()) {
    SerialExecutor serial;
    GroundLayers layers;
    layers.unroll(map_, kCell_m, serial);
    fractal::Reconstruction filled;
    filled.mean_m = Grid<float>(layers.height_m.rows(), layers.height_m.columns(), filled_m);
    filled.draws_m = {filled.mean_m};
    Grid<CellState> state;
    Grid<float> elevation_m;
    CellStates states{StateConfig{}};
    states.close(layers, serial);
    states.classify(layers, std::isfinite(filled_m) ? &filled : nullptr, serial, state, elevation_m);
    return state;
  }
  CellState at(const Grid<CellState>& state, double x_m, double y_m) const {
    const CellIndex cell = lattice_cell(x_m, y_m, kCell_m);
    return state(cell.y - map_.window().min.y, cell.x - map_.window().min.x);
  }
  RollingGrid<MapCell>& map() { return map_; }

 private:
  RollingGrid<MapCell> map_;
  CellPoints points_;
  FrameReturns returns_;
  Fusion fusion_{GroundConfig{}};
  Visibility visibility_;
};

double flat_ground(double, double) {
  return 0.0;
}
double wall(double x_m, double) {
  return x_m > 4.0 && x_m < 4.3 ? 1.0 : 0.0;
}
double ditch(double x_m, double) {
  return x_m > 4.0 && x_m < 5.2 ? -1.0 : 0.0;
}
double cliff(double x_m, double) {
  return x_m > 4.0 ? -3.0 : 0.0;
}
double ramp_down(double x_m, double) {
  return -0.3 * x_m;
}

TEST(Visibility, GroundBehindTheRobotIsNeverSeen) {
  Scene scene;
  scene.look(flat_ground);
  const auto state = scene.states(0.0F);
  for (const double y : {-5.0, 0.0, 5.0})
    for (const double x : {-1.0, -4.0, -9.0}) EXPECT_EQ(scene.at(state, x, y), CellState::never_seen);
  EXPECT_EQ(scene.at(state, 3.0, 0.0), CellState::measured);
}

TEST(Visibility, FlatGroundHasNoDropsAndNoShadows) {
  Scene scene;
  scene.look(flat_ground);
  const auto state = scene.states();
  for (int row = 0; row < state.rows(); ++row)
    for (int column = 0; column < state.columns(); ++column) {
      EXPECT_NE(state(row, column), CellState::possible_drop) << row << ' ' << column;
      EXPECT_FALSE(scene.map()(row, column).shadowed);
    }
}

TEST(Visibility, DescendingGroundHasNoDrops) {
  Scene scene;
  scene.look(ramp_down);
  for (const CellState state : scene.states()) EXPECT_NE(state, CellState::possible_drop);
}

// The wall's top at x = 4 hides the ground to x = 4 · 1.5 / 0.5 = 12 m.
TEST(Visibility, WallCastsAShadow) {
  Scene scene(260);
  scene.look(wall);
  const auto state = scene.states();
  for (const double x : {5.0, 7.0, 9.0, 11.0}) EXPECT_EQ(scene.at(state, x, 0.0), CellState::occluded) << x;
  EXPECT_EQ(scene.at(state, 3.5, 0.0), CellState::measured);
}

TEST(Visibility, NoHiddenCellIsMeasured) {
  Scene scene(260);
  scene.look(wall);
  const auto state = scene.states(0.0F);
  for (double x = 4.6; x < 11.5; x += 0.1)
    for (double y = -1.0; y < 1.0; y += 0.1) EXPECT_NE(scene.at(state, x, y), CellState::measured) << x << ' ' << y;
}

// Rays over the near lip of the ditch reach its far wall at −(1.5/4) · 1.2 = −0.45 m: the cells before that wall have a
// ceiling below the ground by more than the margin (0.2 m) from 0.2 · 4 / 1.5 = 0.54 m behind the lip.
TEST(Visibility, DitchSeenAtAGrazingAngleIsAPossibleDrop) {
  Scene scene;
  scene.look(ditch);
  for (const auto& state : {scene.states(), scene.states(0.0F)})
    for (const double y : {-1.0, 0.05, 1.0})
      for (const double x : {4.75, 4.85, 4.95}) EXPECT_EQ(scene.at(state, x, y), CellState::possible_drop) << x;
}

// Behind the edge rays fall with 1.5/4; the far ground is met at x = 12 m.
TEST(Visibility, GroundBehindACliffEdgeIsAPossibleDropAndNeverInvented) {
  Scene scene(260);
  scene.look(cliff);
  const auto state = scene.states(0.0F);
  for (double x = 4.8; x < 6.9; x += 0.1) EXPECT_EQ(scene.at(state, x, 0.0), CellState::possible_drop) << x;
  for (double x = 7.5; x < 11.5; x += 0.5) EXPECT_EQ(scene.at(state, x, 0.0), CellState::occluded) << x;
}

TEST(Visibility, GapsBetweenScanRowsAreReconstructedOnlyBetweenThem) {
  Scene scene;
  scene.look(flat_ground, 0.5, 220, 24);  // rows 0.04 rad apart: 0.3 m gaps at 3 m
  const auto state = scene.states(0.0F);
  int reconstructed = 0;
  for (double x = 2.5; x < 4.5; x += 0.1) {
    const CellState here = scene.at(state, x, 0.0);
    EXPECT_TRUE(here == CellState::measured || here == CellState::reconstructed) << x;
    reconstructed += here == CellState::reconstructed ? 1 : 0;
  }
  EXPECT_GT(reconstructed, 3);
  const auto without = scene.states();
  for (const CellState here : without) EXPECT_NE(here, CellState::reconstructed);
}

TEST(Visibility, WhatMovedAwayIsForgottenOnceRaysPassThrough) {
  Scene scene;
  scene.look(wall);
  CellIndex cell = lattice_cell(4.05, 0.05, kCell_m);
  while (scene.map().at(cell).height_m < 0.9F && cell.x < 43) ++cell.x;  // on top of the wall
  ASSERT_GT(scene.map().at(cell).height_m, 0.9F);
  for (int frame = 0; frame < kFramesToForget; ++frame)  // now a pit: rays pass where the wall was and hit farther on
    scene.look([](double x, double) { return x > 3.5 && x < 4.5 ? -2.0 : 0.0; });
  EXPECT_FALSE(scene.map().at(cell).measured());
}

TEST(Visibility, DoesNotDependOnTheExecutor) {
  const PointFrame frame = test::scan(wall, {0, 0, 1.5}, -0.5, 0.5, 100, -0.9, 0.05, 60, 25.0);
  Scene serial_scene, other_scene;
  SerialExecutor serial;
  test::ReversedRanges reversed(5);
  serial_scene.look(frame, serial);
  other_scene.look(frame, reversed);
  for (int row = 0; row < 200; ++row)
    for (int column = 0; column < 200; ++column) {
      const MapCell& a = serial_scene.map()(row, column);
      const MapCell& b = other_scene.map()(row, column);
      ASSERT_EQ(a.ceiling_m, b.ceiling_m);
      ASSERT_EQ(a.lip_m, b.lip_m);
      ASSERT_EQ(a.shadowed, b.shadowed);
      ASSERT_EQ(a.height_m, b.height_m);
    }
}

// Ceilings are upper bounds: on random bumps no cell that was crossed has its whole ground above its ceiling.
TEST(Visibility, CeilingsAreNeverBelowTheGround) {
  const test::Height bumps = [](double x, double y) { return 0.15 * std::sin(2.1 * x) * std::cos(1.7 * y) - 0.02 * x; };
  Scene scene;
  scene.look(bumps, 0.5, 300, 300);
  for (int row = 0; row < 200; ++row)
    for (int column = 0; column < 200; ++column) {
      const double x_m = (column - 100) * kCell_m, y_m = (row - 100) * kCell_m;
      double lowest = 1e9;
      for (int i = 0; i <= 10; ++i)
        for (int j = 0; j <= 10; ++j) lowest = std::min(lowest, bumps(x_m + 0.01 * i, y_m + 0.01 * j));
      ASSERT_GE(static_cast<double>(scene.map()(row, column).ceiling_m), lowest - 1e-3) << x_m << ' ' << y_m;
    }
}

TEST(DiamondAngle, GrowsWithTheAzimuth) {
  float before = -1.0F;
  for (int i = 0; i < 1000; ++i) {
    const double azimuth = 2.0 * std::numbers::pi * i / 1000.0;
    const float p = diamond_angle(static_cast<float>(std::cos(azimuth)), static_cast<float>(std::sin(azimuth)));
    EXPECT_GT(p, before);
    before = p;
  }
  EXPECT_LT(before, 4.0F);
}

}  // namespace
}  // namespace scree::mapping
