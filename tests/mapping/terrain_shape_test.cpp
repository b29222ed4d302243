#include "mapping/terrain_shape.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>

#include "core/random.hpp"
#include "tests/mapping/support.hpp"

namespace scree::mapping {
namespace {

constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();

struct Shape {
  Grid<float> slope_rad, step_m;
};

Shape shape_of(const Grid<float>& elevation_m, float noise_variance_m2 = 0.0F, float relief_m2 = 0.0F) {
  SerialExecutor serial;
  TerrainShape shape(ShapeConfig{});
  const Grid<float> variance(elevation_m.rows(), elevation_m.columns(), noise_variance_m2);
  const Grid<float> relief(elevation_m.rows(), elevation_m.columns(), relief_m2);
  Shape out;
  shape.update(elevation_m, variance, relief, serial, out.slope_rad, out.step_m);
  return out;
}

Grid<float> heights(int side, const test::Height& height) {
  Grid<float> grid(side, side);
  for (int row = 0; row < side; ++row)
    for (int column = 0; column < side; ++column)
      grid(row, column) = static_cast<float>(height(0.1 * (column + 0.5), 0.1 * (row + 0.5)));
  return grid;
}

TEST(TerrainShape, FlatPlaneHasNeitherSlopeNorStep) {
  const Shape shape = shape_of(heights(20, [](double, double) { return 312.5; }));
  for (const float slope : shape.slope_rad) EXPECT_EQ(slope, 0.0F);
  for (const float step : shape.step_m) EXPECT_EQ(step, 0.0F);
}

// Heights near 300 m: the grid's own float32 rounding (1.5e-5 m) bounds the error at 1e-4 rad.
TEST(TerrainShape, TiltedPlaneHasItsExactSlopeEverywhereAndWithGaps) {
  Grid<float> plane = heights(30, [](double x, double y) { return 300.0 + 0.3 * x - 0.2 * y; });
  for (const bool gaps : {false, true}) {
    if (gaps)
      for (int row = 0; row < 30; ++row)
        for (int column = 0; column < 30; ++column)
          if (to_uniform(random_words(1, 1, column, row)[0]) < 0.5) plane(row, column) = kUnknown;
    const Shape shape = shape_of(plane);
    for (std::size_t i = 0; i < plane.size(); ++i) {
      if (std::isnan(plane[i])) continue;
      EXPECT_NEAR(shape.slope_rad[i], std::atan(std::hypot(0.3, 0.2)), 1e-4);
    }
  }
}

// White heights, σ = 1 cm, on a slope: 400 separate full windows of 49 − 3 degrees of freedom; their mean variance has
// relative standard error √(2 / (400 · 46)) = 1.04 %. Bound 4 s.e., false-alarm rate 6e-5.
TEST(TerrainShape, StepOfATiltedPlaneIsItsRiseOverAWheelRadius) {
  const Shape shape = shape_of(heights(20, [](double x, double y) { return 0.2 * x + 0.2 * y; }));
  EXPECT_NEAR(shape.step_m(10, 10), 0.04F, 1e-5F);
}

TEST(TerrainShape, EdgeHasItsHeightAsStepOnBothSidesAndNowhereElse) {
  const Shape shape = shape_of(heights(20, [](double x, double) { return x > 1.0 ? 0.25 : 0.0; }));
  for (int column = 0; column < 20; ++column)
    EXPECT_NEAR(shape.step_m(10, column), column == 9 || column == 10 ? 0.25F : 0.0F, 1e-6F) << column;
}

TEST(TerrainShape, UnknownCellsStayUnknownAndDoNotMakeSteps) {
  Grid<float> elevation = heights(20, [](double, double) { return 5.0; });
  elevation(10, 10) = kUnknown;
  const Shape shape = shape_of(elevation);
  EXPECT_TRUE(std::isnan(shape.slope_rad(10, 10)));
  EXPECT_TRUE(std::isnan(shape.step_m(10, 10)));
  EXPECT_EQ(shape.step_m(10, 11), 0.0F);
  EXPECT_EQ(shape.slope_rad(10, 11), 0.0F);
}

TEST(TerrainShape, ALineOfCellsHasNoSlope) {
  Grid<float> elevation(20, 20, kUnknown);
  for (int column = 0; column < 20; ++column) elevation(7, column) = 1.0F;
  for (const float slope : shape_of(elevation).slope_rad) EXPECT_TRUE(std::isnan(slope));
}

// 400 cells of 8 differences each: a normal difference beyond two of its deviations is 4.6 % likely, so most of the
// plain would be steps without the noise term; beyond 5 deviations (step > √21 σ) none is expected (3200 · 6e-7).
TEST(TerrainShape, NoiseMakesSmallStepsOnly) {
  constexpr float kSigma_m = 0.02F;
  Grid<float> noisy(20, 20);
  for (int row = 0; row < 20; ++row)
    for (int column = 0; column < 20; ++column)
      noisy(row, column) = kSigma_m * static_cast<float>(random_normals(5, 1, column, row)[0]);
  const Shape shape = shape_of(noisy, kSigma_m * kSigma_m);
  int none = 0;
  for (const float step : shape.step_m) {
    EXPECT_LT(step, std::sqrt(42.0F) * kSigma_m);
    none += step == 0.0F ? 1 : 0;
  }
  EXPECT_GT(none, 200);
}

TEST(TerrainShape, NoiseDoesNotHideARealEdge) {
  const Shape shape = shape_of(heights(20, [](double x, double) { return x > 1.0 ? 0.25 : 0.0; }), 4e-4F);
  EXPECT_GT(shape.step_m(10, 9), 0.24F);
}

TEST(TerrainShape, ReliefInsideACellIsAStepOfAnEvenlySampledFace) {
  const Shape shape = shape_of(heights(10, [](double, double) { return 0.0; }), 0.0F, 0.6F * 0.6F / 12.0F);
  EXPECT_NEAR(shape.step_m(5, 5), 0.6F, 1e-6F);
}

}  // namespace
}  // namespace scree::mapping
