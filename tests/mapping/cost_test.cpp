#include "mapping/cost.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>

#include "mapping/snapshot.hpp"

namespace scree::mapping {
namespace {

CellRisk cell(float risk, float tail, CellState state = CellState::measured) {
  return {state, risk, tail, true};
}

TEST(Cost, IdealGroundIsFree) {
  EXPECT_EQ(cell_cost(cell(0.0F, 0.0F), {}), kCostFree);
}

TEST(Cost, GrowsWithTheRiskAndWithTheTail) {
  int by_risk = -1, by_tail = -1;
  for (int i = 0; i <= 100; ++i) {
    const float t = 0.01F * static_cast<float>(i);
    const int risk = cell_cost(cell(t, 0.3F), {.lethal_risk = 1.0}), tail = cell_cost(cell(0.2F, 1.5F * t), {});
    EXPECT_GE(risk, by_risk);
    EXPECT_GE(tail, by_tail);
    EXPECT_NE(risk, 253);
    by_risk = risk;
    by_tail = tail;
  }
  EXPECT_EQ(by_risk, kCostLethal);
}

TEST(Cost, IsLethalFromTheConfiguredRiskOn) {
  EXPECT_LE(cell_cost(cell(0.299F, 1.0F), {.lethal_risk = 0.3}), kCostMax);
  EXPECT_EQ(cell_cost(cell(0.3F, 0.1F), {.lethal_risk = 0.3}), kCostLethal);
}

// All of a limit in every draw is a coin toss.
TEST(Cost, GroundThatTakesAllOfALimitCostsThreeQuarters) {
  EXPECT_EQ(cell_cost(cell(0.5F, 1.0F), {}), kCostMax * 3 / 4);
}

TEST(Cost, UnseenGroundIsUnknownAndAPossibleDropIsLethal) {
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(cell_cost(cell(0, 0, CellState::never_seen), {}), kCostUnknown);
  EXPECT_EQ(cell_cost(cell(0, 0, CellState::occluded), {}), kCostUnknown);
  EXPECT_EQ(cell_cost(cell(0, 0, CellState::possible_drop), {}), kCostLethal);
  EXPECT_EQ(cell_cost(cell(kNaN, kNaN), {}), kCostUnknown);
}

TEST(Cost, UnmeasuredGroundIsNeverCheaperThanTheFloor) {
  EXPECT_EQ(cell_cost(cell(0, 0, CellState::reconstructed), {.unmeasured_floor = 90}), 90);
  EXPECT_GT(cell_cost(cell(0.4F, 1.0F, CellState::reconstructed), {}), CostConfig{}.unmeasured_floor);
}

TEST(Cost, AWheelOnUnknownGroundCountsAsUnmeasured) {
  CellRisk rim = cell(0, 0, CellState::measured);
  rim.on_unknown = true;
  EXPECT_EQ(cell_cost(rim, {.unmeasured_floor = 90}), 90);
}

TEST(Cost, UnknownRoughnessIsNeverFree) {
  EXPECT_EQ(cell_cost({CellState::measured, 0.0F, 0.0F, false}, {}), kUnknownRoughnessFloor);
}

TEST(Cost, LethalDecaysToUnknownAndIsForgottenOnlyWhenMeasuredAnew) {
  bool lethal = false;
  EXPECT_EQ(guarded_cost(CellState::reconstructed, 70, lethal), 70);
  EXPECT_EQ(guarded_cost(CellState::measured, kCostLethal, lethal), kCostLethal);
  EXPECT_EQ(guarded_cost(CellState::reconstructed, 70, lethal), kCostUnknown);
  EXPECT_EQ(guarded_cost(CellState::possible_drop, kCostLethal, lethal), kCostLethal);
  EXPECT_EQ(guarded_cost(CellState::occluded, kCostUnknown, lethal), kCostUnknown);
  EXPECT_EQ(guarded_cost(CellState::measured, kCostUnknown, lethal), kCostUnknown);  // not judged: at the border
  EXPECT_TRUE(lethal);
  EXPECT_EQ(guarded_cost(CellState::measured, 12, lethal), 12);
  EXPECT_EQ(guarded_cost(CellState::reconstructed, 70, lethal), 70);
}

}  // namespace
}  // namespace scree::mapping
