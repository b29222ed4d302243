#include "io/picture_layout.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>

namespace scree::io {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

TEST(PictureLayout, TicksAreRoundAndWithinTheLimits) {
  const auto result = ticks(-0.31, 0.42, 7);
  ASSERT_GE(result.size(), 4u);
  EXPECT_EQ(result.front().label, "-0.2");
  EXPECT_EQ(result.back().label, "0.4");
  for (std::size_t i = 1; i < result.size(); ++i) EXPECT_NEAR(result[i].value - result[i - 1].value, 0.2, 1e-12);
  EXPECT_TRUE(ticks(1.0, 1.0, 5).empty());
}

TEST(PictureLayout, RoundLengthIsTheGreatestThatFits) {
  EXPECT_EQ(round_length(4.2).label, "2");
  EXPECT_EQ(round_length(5.0).label, "5");
  EXPECT_EQ(round_length(0.09).label, "0.05");
  EXPECT_EQ(round_length(130.0).label, "100");
}

TEST(PictureLayout, KnownBlockHoldsEveryKnownCell) {
  Grid<float> grid(100, 100, kNaN);
  grid(10, 95) = 1.0f;
  grid(60, 70) = 2.0f;
  const CellBlock block = known_block({&grid});
  EXPECT_LE(block.row, 10);
  EXPECT_GT(block.row + block.rows, 60);
  EXPECT_LE(block.column, 70);
  EXPECT_EQ(block.column + block.columns, 100);
  EXPECT_LT(block.rows, 70);
  const Grid<float> unknown(3, 4, kNaN);
  EXPECT_EQ(known_block({&unknown}).columns, 4);
}

TEST(PictureLayout, LevelGroundIsEvenlyLitAndNorthWestSlopesAreBrighter) {
  Grid<float> level(5, 5, 2.0f);
  for (const float light : hillshade(level, 0.1)) EXPECT_NEAR(light, std::sqrt(0.5), 1e-6);
  Grid<float> towards_light(5, 5), away(5, 5);
  for (int r = 0; r < 5; ++r) {
    for (int c = 0; c < 5; ++c) {
      towards_light(r, c) = 0.05f * static_cast<float>(c - r);  // rises to the south-east: faces the north-west
      away(r, c) = -towards_light(r, c);
    }
  }
  EXPECT_GT(hillshade(towards_light, 0.1)(2, 2), 0.8f);
  EXPECT_LT(hillshade(away, 0.1)(2, 2), 0.5f);
}

}  // namespace
}  // namespace scree::io
