#include "fractal/reconstruction/ceiling_push.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>

#include "fractal/reconstruction/blend_prior.hpp"

namespace scree::fractal {
namespace {

constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
constexpr int kSide = 64;

/// A flat sample at 0 with a datum at every eighth cell, and a square without data that rays passed 2 units below it.
struct Valley {
  MultigridShape shape{kSide, kSide};
  BlendField prior;
  PaddedField precision, sample;
  Grid<float> ceiling{kSide, kSide, kNone};

  Valley() {
    prior.uniform = blend_weights(2.5, 0.65);
    precision.resize(shape.rows, shape.columns);
    sample.resize(shape.rows, shape.columns);
    for (int r = 0; r < kSide; ++r)
      for (int c = 0; c < kSide; ++c) {
        if (r % 8 == 0 && c % 8 == 0 && !inside(r, c)) precision.row(r)[c] = 1000.0F;
        if (inside(r, c)) ceiling(r, c) = -2.0F;
      }
  }
  static bool inside(int r, int c) { return r > 20 && r < 44 && c > 20 && c < 44; }
  bool push(CeilingPush& with, const Grid<float>& change = {}) {
    return with.apply(shape, prior, precision, ceiling, change, 0.01, 100, sample);
  }
};

TEST(CeilingPush, LowersWhatRaysPassedOver) {
  Valley valley;
  CeilingPush push;
  ASSERT_TRUE(valley.push(push));
  EXPECT_GT(push.iterations(), 0);
  for (int r = 24; r < 41; ++r)
    for (int c = 24; c < 41; ++c) EXPECT_LT(valley.sample.row(r)[c], -1.5F) << r << ' ' << c;
}

TEST(CeilingPush, LeavesTheDataAlone) {
  Valley valley;
  CeilingPush push;
  ASSERT_TRUE(valley.push(push));
  for (int r = 0; r < kSide; r += 8)
    for (int c = 0; c < kSide; c += 8)
      EXPECT_TRUE(Valley::inside(r, c) || std::abs(valley.sample.row(r)[c]) < 0.1F) << r << ' ' << c;
}

TEST(CeilingPush, ASampleBelowItsCeilingsStays) {
  Valley valley;
  for (float& z : valley.ceiling)
    if (!std::isnan(z)) z = 0.5F;
  CeilingPush push;
  EXPECT_FALSE(valley.push(push));
  for (int r = 0; r < kSide; ++r)
    for (int c = 0; c < kSide; ++c) EXPECT_EQ(valley.sample.row(r)[c], 0.0F);
}

// Heights, changes and ceilings three times as large: so is the push.
TEST(CeilingPush, TheChangeOfTheCellIsTheUnit) {
  Valley one, three;
  CeilingPush push;
  ASSERT_TRUE(one.push(push));
  three.prior.uniform = {one.prior.uniform.w1 / 9.0F, one.prior.uniform.w2 / 9.0F};
  for (int r = 0; r < kSide; ++r)
    for (int c = 0; c < kSide; ++c) {
      three.precision.row(r)[c] /= 9.0F;
      three.ceiling(r, c) *= 3.0F;
    }
  ASSERT_TRUE(three.push(push, Grid<float>(kSide, kSide, 3.0F)));
  for (int r = 0; r < kSide; ++r)
    for (int c = 0; c < kSide; ++c)
      ASSERT_NEAR(three.sample.row(r)[c], 3.0F * one.sample.row(r)[c], 0.05F) << r << ' ' << c;
}

}  // namespace
}  // namespace scree::fractal
