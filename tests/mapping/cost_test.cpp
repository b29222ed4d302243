#include "mapping/cost.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>

#include "mapping/snapshot.hpp"

namespace scree::mapping {
namespace {

GroundShape ground(float slope_rad, float step_m, double amplitude_m, CellState state = CellState::measured) {
  return {state, slope_rad, step_m, fractal::FractalLaw{2.4, amplitude_m}};
}

TEST(Cost, IdealGroundIsFree) {
  EXPECT_EQ(cell_cost(ground(0, 0, 0), {}), kCostFree);
}

TEST(Cost, GrowsWithSlopeStepAndRoughness) {
  int before[3] = {-1, -1, -1};
  for (int i = 0; i <= 60; ++i) {
    const auto t = static_cast<float>(i) / 50.0F;
    const int now[3] = {cell_cost(ground(0.35F * t, 0.02F, 0.01), {}), cell_cost(ground(0.1F, 0.12F * t, 0.01), {}),
                        cell_cost(ground(0.1F, 0.02F, 0.3 * static_cast<double>(t)), {})};
    for (int k = 0; k < 3; ++k) {
      EXPECT_GE(now[k], before[k]) << "hazard " << k << " at " << t;
      EXPECT_NE(now[k], 253);
      before[k] = now[k];
    }
  }
  for (const int last : before) EXPECT_EQ(last, kCostLethal);
}

TEST(Cost, IsLethalFromTheVehiclesLimitsOn) {
  const VehicleConfig vehicle;
  const auto limit = static_cast<float>(vehicle.max_roll_rad);
  EXPECT_LE(cell_cost(ground(limit - 1e-3F, 0, 0), vehicle), kCostMax);
  EXPECT_EQ(cell_cost(ground(limit + 1e-3F, 0, 0), vehicle), kCostLethal);
  EXPECT_LE(cell_cost(ground(0, 0.119F, 0), vehicle), kCostMax);
  EXPECT_EQ(cell_cost(ground(0, 0.121F, 0), vehicle), kCostLethal);
}

TEST(Cost, LowBellyIsStoppedByRoughnessThatTheWheelsBear) {
  VehicleConfig vehicle;
  EXPECT_LE(cell_cost(ground(0, 0, 0.08), vehicle), kCostMax);
  vehicle.clearance_m = 0.04;
  EXPECT_EQ(cell_cost(ground(0, 0, 0.08), vehicle), kCostLethal);
}

// Near D = 2 the surface is a bundle of planes: a large amplitude at 1 m is slope, which is judged as such, not relief.
TEST(Cost, PlanesAreNotRough) {
  const GroundShape smooth{CellState::measured, 0.0F, 0.0F, fractal::FractalLaw{2.0 + 1e-9, 0.3}};
  const Hazards h = hazards(smooth, {});
  EXPECT_LT(h.roughness, 1e-3);
  EXPECT_LT(h.roll, 1e-3);
  EXPECT_LT(h.clearance, 1e-3);
}

// A trunk a metre away fills the window of D; the footprint itself is as flat as a table.
TEST(Cost, RoughnessBesideAMeasuredFootprintIsBoundedByWhatItShows) {
  GroundShape beside{CellState::measured, 0.0F, 0.01F, fractal::FractalLaw{2.4, 2.0}};
  EXPECT_EQ(cell_cost(beside, {}), kCostLethal);
  beside.deviation_m = 0.002F;
  EXPECT_LT(cell_cost(beside, {}), 20);
  beside.deviation_m = 10.0F;
  EXPECT_EQ(cell_cost(beside, {}), kCostLethal);
}

TEST(Cost, WhiteHeightsAreJudgedByTheirRmsChange) {
  const VehicleConfig vehicle;
  const GroundShape white{CellState::measured, 0.0F, 0.0F, fractal::FractalLaw{3.0, 0.03}};
  EXPECT_NEAR(hazards(white, vehicle).roughness, 2.0 * 0.03 / vehicle.max_step_m, 1e-12);
}

TEST(Cost, UnseenGroundIsUnknownAndAPossibleDropIsLethal) {
  EXPECT_EQ(cell_cost(ground(0, 0, 0, CellState::never_seen), {}), kCostUnknown);
  EXPECT_EQ(cell_cost(ground(0, 0, 0, CellState::occluded), {}), kCostUnknown);
  EXPECT_EQ(cell_cost(ground(0, 0, 0, CellState::possible_drop), {}), kCostLethal);
  EXPECT_EQ(cell_cost(ground(std::numeric_limits<float>::quiet_NaN(), 0, 0), {}), kCostUnknown);
}

TEST(Cost, InventedGroundIsNeverCheap) {
  EXPECT_EQ(cell_cost(ground(0, 0, 0, CellState::reconstructed), {}), kReconstructedFloor);
  EXPECT_GT(cell_cost(ground(0.3F, 0.05F, 0.02, CellState::reconstructed), {}), kReconstructedFloor);
}

TEST(Cost, UnknownRoughnessIsNeverFree) {
  EXPECT_EQ(cell_cost({CellState::measured, 0.0F, 0.0F, std::nullopt}, {}), kUnknownRoughnessFloor);
}

}  // namespace
}  // namespace scree::mapping
