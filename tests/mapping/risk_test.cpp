#include "mapping/risk.hpp"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

#include "core/random.hpp"
#include "tests/mapping/support.hpp"

namespace scree::mapping {
namespace {

constexpr int kSide = 60;
constexpr double kCell_m = 0.1;

using Draws = std::vector<Grid<float>>;

Draws draws_of(const test::Height& height, int count = 8) {
  Grid<float> grid(kSide, kSide);
  for (int r = 0; r < kSide; ++r)
    for (int c = 0; c < kSide; ++c) grid(r, c) = static_cast<float>(height(kCell_m * c, kCell_m * r));
  return Draws(static_cast<std::size_t>(count), grid);
}

Risk risk_of(const Draws& draws, RiskConfig config = {}) {
  SerialExecutor serial;
  FootprintRisk risk(config);
  Risk out;
  const Grid<float> none(kSide, kSide, 0.0F);
  const Grid<CellState> measured(kSide, kSide, CellState::measured);
  risk.update(draws, {none, none, measured}, Grid<std::uint8_t>(kSide, kSide, 1), serial, out);
  return out;
}

double normal(double z) {
  return 0.5 * std::erfc(-z / std::numbers::sqrt2);
}

TEST(FootprintRisk, LevelGroundTakesNothing) {
  const Risk risk = risk_of(draws_of([](double, double) { return 3.0; }));
  EXPECT_LT(risk.worst(30, 30), 1e-6F);
  EXPECT_LT(risk.tail(30, 30), 1e-6F);
}

// Known planes: the load is the larger of the shares of pitch and roll, and the rest is the model error's normal law.
TEST(FootprintRisk, ASlopeIsJudgedByHeading) {
  const double slope = 0.3;
  RiskConfig config;
  config.vehicle.max_step_m = 10.0;
  const Risk risk = risk_of(draws_of([&](double x, double) { return slope * x; }), config);
  double worst = 0.0, tail = 0.0;
  for (int k = 0; k < config.headings; ++k) {
    const double heading = (k + 0.5) * std::numbers::pi / config.headings;
    const double pitch = slope * std::abs(std::cos(heading)) / std::tan(config.vehicle.max_pitch_rad);
    const double roll = slope * std::abs(std::sin(heading)) / std::tan(config.vehicle.max_roll_rad);
    const double load = std::max(pitch, roll);
    const double expected = normal((load - 1.0) / static_cast<double>(FootprintRisk::kModelError));
    EXPECT_NEAR(risk.sector[static_cast<std::size_t>(k)](30, 30), expected, 5e-4) << k;
    worst = std::max(worst, expected);
    tail = std::max(tail, load);
  }
  EXPECT_NEAR(risk.worst(30, 30), worst, 5e-4);
  EXPECT_NEAR(risk.tail(30, 30), tail, 1e-4);
}

TEST(FootprintRisk, AStoneUnderTheBellyStopsAVehicleThatTheWheelsWouldCarry) {
  RiskConfig config;
  config.vehicle.max_step_m = 10.0;
  config.vehicle.max_pitch_rad = config.vehicle.max_roll_rad = 1.4;
  const auto stone = [](double x, double y) {
    return std::hypot(x - 3.0, y - 3.0) < 0.05 ? 0.25 : 0.0;  // one cell, at (30, 30)
  };
  const Risk risk = risk_of(draws_of(stone), config);
  EXPECT_GT(risk.worst(30, 30), 0.99F);  // 0.25 m over a clearance of 0.15 m
  EXPECT_LT(risk.worst(30, 40), 1e-3F);
  config.vehicle.clearance_m = 0.5;
  EXPECT_LT(risk_of(draws_of(stone), config).worst(30, 30), 1e-3F);
}

TEST(FootprintRisk, AnEdgeIsAStepForTheWheelsNextToItOnly) {
  const Risk risk = risk_of(draws_of([](double x, double) { return x < 2.95 ? 0.0 : 0.2; }));
  EXPECT_GT(risk.worst(30, 30), 0.99F);
  for (int c = 6; c < 54; ++c) {
    // the farthest wheel stands 0.39 m away, rounded to a cell, and feels a cell farther
    if (c < 30 - 6 || c > 29 + 6) {
      EXPECT_LT(risk.worst(30, c), 1e-3F) << c;
    }
  }
}

// Independent check: the same footprint evaluated draw by draw, cell by cell.
TEST(FootprintRisk, EqualsThePlainEvaluationOnRandomGround) {
  Draws draws;
  for (int k = 0; k < 5; ++k) {
    Grid<float> grid(kSide, kSide);
    for (int r = 0; r < kSide; ++r)
      for (int c = 0; c < kSide; ++c)
        grid(r, c) = static_cast<float>(0.03 * random_normals(3, static_cast<std::uint64_t>(k), c, r)[0] + 0.02 * c);
    draws.push_back(grid);
  }
  RiskConfig config;
  const Grid<float> relief(kSide, kSide, 0.0001F), face(kSide, kSide, 0.0007F);
  SerialExecutor serial;
  FootprintRisk fast(config);
  Risk risk;
  const Grid<CellState> measured(kSide, kSide, CellState::measured);
  fast.update(draws, {relief, face, measured}, Grid<std::uint8_t>(kSide, kSide, 1), serial, risk);
  const double peak = static_cast<double>(FootprintRisk::kPeak);
  const auto all = footprints(config.vehicle, kCell_m, config.headings);
  for (const CellIndex at : {CellIndex{20, 33}, CellIndex{5, 5}, CellIndex{41, 12}})
    for (std::size_t h = 0; h < all.size(); ++h) {
      double sum = 0.0, square = 0.0, share = 0.0;
      for (const Grid<float>& draw : draws) {
        const auto z = [&](CellIndex o) { return static_cast<double>(draw(at.y + o.y, at.x + o.x)); };
        double level = 0.0, along = 0.0, across = 0.0, load = 0.0;
        for (std::size_t w = 0; w < 4; ++w) {
          const CellIndex o = all[h].wheels[w].offset;
          level += static_cast<double>(all[h].level[w]) * z(o);
          along += static_cast<double>(all[h].along[w]) * z(o);
          across += static_cast<double>(all[h].across[w]) * z(o);
          double step = 0.0;
          for (const CellIndex d : {CellIndex{1, 0}, CellIndex{-1, 0}, CellIndex{0, 1}, CellIndex{0, -1},
                                    CellIndex{1, 1}, CellIndex{1, -1}, CellIndex{-1, 1}, CellIndex{-1, -1}}) {
            const int row = at.y + o.y + d.y, column = at.x + o.x + d.x;
            if (draw.contains(row, column))
              step = std::max(step, std::abs(static_cast<double>(draw(row, column)) - z(o)));
          }
          load = std::max(load,
                          std::sqrt(step * step + 0.0007 + static_cast<double>(FootprintRisk::kStepRelief) * 0.0001) /
                              config.vehicle.max_step_m);
        }
        load = std::max({load, std::abs(along) / std::tan(config.vehicle.max_pitch_rad),
                         std::abs(across) / std::tan(config.vehicle.max_roll_rad)});
        for (const auto& part : all[h].belly)
          load =
              std::max(load, (z(part.offset) + std::sqrt(peak * peak * 0.0001 + 0.0007) - level -
                              static_cast<double>(part.along_m) * along - static_cast<double>(part.across_m) * across) /
                                 config.vehicle.clearance_m);
        load = std::min(load, static_cast<double>(FootprintRisk::kMostLoad));
        sum += load;
        square += load * load;
        share += std::clamp((load - 1.0) / (std::sqrt(12.0) * static_cast<double>(FootprintRisk::kModelError)) + 0.5,
                            0.0, 1.0) /
                 5.0;
      }
      const double n = 5.0, mean = sum / n, variance = (square / n - mean * mean) * n / (n - 1.0);
      const double error = static_cast<double>(FootprintRisk::kModelError);
      const double expected =
          std::max(share, normal((mean - 1.0) / std::sqrt((1.0 + 1.0 / n) * variance + error * error)));
      EXPECT_NEAR(risk.sector[h](at.y, at.x), expected, 1e-3) << at.x << ' ' << h;
    }
}

// Flat, but for what is stated of one cell: risk at the centre (30, 30) of a vehicle with a wheel, or its belly, on it.
struct Underneath {
  Grid<float> relief = Grid<float>(kSide, kSide, 0.0F), face = Grid<float>(kSide, kSide, 0.0F);
  Grid<CellState> state = Grid<CellState>(kSide, kSide, CellState::measured);
  Risk risk() const {
    SerialExecutor serial;
    FootprintRisk of({});
    Risk out;
    of.update(draws_of([](double, double) { return 0.0; }), {relief, face, state}, Grid<std::uint8_t>(kSide, kSide, 1),
              serial, out);
    return out;
  }
};

// The mean of a post's cell may be that of the floor around it; its face says that it is there.
TEST(FootprintRisk, AFaceUnderTheBellyViolatesWhateverTheDrawsSay) {
  Underneath ground;
  ground.face(30, 30) = 0.3F * 0.3F;
  EXPECT_GT(ground.risk().worst(30, 30), 0.99F);
}

TEST(FootprintRisk, AWheelOverAWidePossibleDropViolatesAndRollsOverANarrowOne) {
  Underneath narrow, wide;
  for (int row = 0; row < kSide; ++row) {
    for (int column = 35; column < 37; ++column) narrow.state(row, column) = CellState::possible_drop;
    for (int column = 35; column < 45; ++column) wide.state(row, column) = CellState::possible_drop;
  }
  EXPECT_LT(narrow.risk().worst(30, 33), 0.01F);  // 0.2 m: a wheel of 0.15 m sinks by 0.04 m
  EXPECT_GT(wide.risk().worst(30, 33), 0.99F);
  EXPECT_LT(wide.risk().worst(30, 28), 0.01F);
}

TEST(FootprintRisk, SaysWhereAWheelStandsOnUnknownGround) {
  Underneath ground;
  for (int row = 0; row < kSide; ++row)
    for (int column = 35; column < kSide; ++column) ground.state(row, column) = CellState::occluded;
  const Risk risk = ground.risk();
  EXPECT_EQ(risk.on_unknown(30, 33), 1.0F);
  EXPECT_EQ(risk.on_unknown(30, 28), 0.0F);
}

// Draws that differ in height alone make steps of known size: one ever worse draw never makes a violation less likely
// than the share of those that violate.
TEST(FootprintRisk, AWorseDrawNeverHidesTheOthers) {
  const auto draw = [](double step_m) {
    return draws_of([step_m](double x, double) { return x > 3.0 ? step_m : 0.0; }, 1).front();
  };
  float before = 0.0F;
  for (const double worst_m : {0.18, 0.3, 0.6, 1.2}) {
    Draws draws(7, draw(0.18));
    draws.push_back(draw(worst_m));
    const float risk = risk_of(draws).worst(30, 30);
    EXPECT_GT(risk, 0.99F) << worst_m;  // 0.18 m is one and a half times the step that the wheels may climb
    EXPECT_GE(risk, before - 1e-6F);
    before = std::min(risk, 1.0F);
  }
}

TEST(FootprintRisk, IsUnknownWithinAFootprintOfTheBorder) {
  const Risk risk = risk_of(draws_of([](double, double) { return 0.0; }));
  EXPECT_TRUE(std::isnan(risk.worst(0, 30)));
  EXPECT_TRUE(std::isnan(risk.worst(30, kSide - 1)));
  EXPECT_TRUE(std::isfinite(risk.worst(5, 5)));
}

TEST(FootprintRisk, CellsThatAreAskedForAloneAreJudgedAlike) {
  const Draws draws = draws_of([](double x, double y) { return 0.1 * std::sin(7.0 * x) * std::cos(5.0 * y); });
  const Risk all = risk_of(draws);
  Grid<std::uint8_t> asked(kSide, kSide, 0);
  for (int r = 0; r < kSide; ++r)
    for (int c = 0; c < kSide; ++c) asked(r, c) = to_uniform(random_words(1, 1, c, r)[0]) < 0.2 ? 1 : 0;
  FootprintRisk some({});
  Risk risk;
  SerialExecutor serial;
  const Grid<float> none(kSide, kSide, 0.0F);
  some.update(draws, {none, none, Grid<CellState>(kSide, kSide, CellState::measured)}, asked, serial, risk);
  for (int r = 5; r < kSide - 5; ++r)
    for (int c = 5; c < kSide - 5; ++c)
      if (asked(r, c) != 0) {
        ASSERT_EQ(risk.worst(r, c), all.worst(r, c)) << r << ' ' << c;
        ASSERT_EQ(risk.tail(r, c), all.tail(r, c));
      }
}

TEST(FootprintRisk, DoesNotDependOnTheExecutor) {
  const Draws draws = draws_of([](double x, double y) { return 0.1 * std::sin(7.0 * x) * std::cos(5.0 * y); });
  FootprintRisk one({}), two({});
  Risk a, b;
  SerialExecutor serial;
  test::ReversedRanges reversed(7);
  const Grid<float> none(kSide, kSide, 0.0F);
  const Grid<std::uint8_t> asked(kSide, kSide, 1);
  const Grid<CellState> measured(kSide, kSide, CellState::measured);
  one.update(draws, {none, none, measured}, asked, serial, a);
  two.update(draws, {none, none, measured}, asked, reversed, b);
  for (int r = 5; r < kSide - 5; ++r)
    for (int c = 5; c < kSide - 5; ++c) {
      ASSERT_EQ(a.worst(r, c), b.worst(r, c));
      ASSERT_EQ(a.tail(r, c), b.tail(r, c));
    }
}

}  // namespace
}  // namespace scree::mapping
