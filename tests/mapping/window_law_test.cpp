#include "mapping/window_law.hpp"

#include <cmath>
#include <gtest/gtest.h>

#include "core/random.hpp"

namespace scree::mapping {
namespace {

struct Cells {
  fractal::DimensionMap map;
  Grid<std::uint8_t> measured;
};

Cells cells(int side, float dimension, float amplitude_m) {
  Cells out;
  out.map.dimension.assign(side, side, dimension);
  out.map.dimension_sigma.assign(side, side, 0.05F);
  out.map.amplitude_m.assign(side, side, amplitude_m);
  out.map.flags.assign(side, side, 0);
  out.measured.assign(side, side, 1);
  return out;
}

TEST(WindowLaw, IsTheCommonLawOfEqualCells) {
  const Cells given = cells(10, 2.37F, 0.08F);
  const auto law = WindowLaw().estimate(given.map, given.measured);
  ASSERT_TRUE(law);
  EXPECT_NEAR(law->dimension, 2.37, 1.0 / 1024);
  EXPECT_NEAR(law->amplitude_m, 0.08, 0.001);
}

TEST(WindowLaw, AMinorityOfOddCellsDoesNotMoveIt) {
  Cells given = cells(20, 2.3F, 0.05F);
  for (std::size_t i = 0; i < 120; ++i) {
    given.map.dimension[i] = 2.9F;
    given.map.amplitude_m[i] = 2.0F;
  }
  const auto law = WindowLaw().estimate(given.map, given.measured);
  ASSERT_TRUE(law);
  EXPECT_NEAR(law->dimension, 2.3, 2.0 / 1024);
  EXPECT_NEAR(law->amplitude_m, 0.05, 0.001);
}

TEST(WindowLaw, TooFewCellsGiveNoLaw) {
  Cells given = cells(10, 2.3F, 0.05F);
  given.measured.assign(10, 10, 0);
  for (std::size_t i = 0; i < kLawCells - 1; ++i) given.measured[i] = 1;
  EXPECT_FALSE(WindowLaw().estimate(given.map, given.measured));
  given.measured[kLawCells] = 1;
  EXPECT_TRUE(WindowLaw().estimate(given.map, given.measured));
  given.map.flags.assign(10, 10, fractal::kTooLittleData);
  EXPECT_FALSE(WindowLaw().estimate(given.map, given.measured));
}

TEST(WindowLaw, FlaggedCellsServeOnlyWhenCleanOnesAreMissing) {
  Cells given = cells(10, 2.3F, 0.05F);
  for (std::size_t i = 0; i < 60; ++i) {
    given.map.dimension[i] = 2.8F;
    given.map.flags[i] = fractal::kNoiseLimited;
  }
  EXPECT_NEAR(WindowLaw().estimate(given.map, given.measured)->dimension, 2.3, 2.0 / 1024);
  given.map.flags.assign(10, 10, fractal::kNoiseLimited);
  EXPECT_TRUE(WindowLaw().estimate(given.map, given.measured));
}

TEST(WindowLaw, ExactPlanesGiveTheSmoothestLaw) {
  Cells given = cells(10, 2.02F, 0.0F);
  given.map.dimension_sigma.assign(10, 10, std::nanf(""));
  given.map.flags.assign(10, 10, fractal::kAtBound);
  const auto law = WindowLaw().estimate(given.map, given.measured);
  ASSERT_TRUE(law);
  EXPECT_EQ(law->dimension, 2.05);
  EXPECT_GT(law->amplitude_m, 0.0);
  EXPECT_LT(law->amplitude_m, 2e-4);
}

TEST(WindowLaw, FollowingConvergesAndTakesSmallSteps) {
  fractal::FractalLaw law{2.2, 0.01};
  const fractal::FractalLaw seen{2.7, 1.0};
  EXPECT_NEAR(follow(law, seen).dimension, 2.3, 1e-12);
  for (int i = 0; i < 100; ++i) law = follow(law, seen);
  EXPECT_NEAR(law.dimension, 2.7, 1e-6);
  EXPECT_NEAR(law.amplitude_m, 1.0, 1e-6);
}

}  // namespace
}  // namespace scree::mapping
