#include "fractal/structure_dimension.hpp"

#include "vecchia_scene.hpp"
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <string>
#include <vector>

namespace scree::fractal {
namespace {

DimensionEstimate estimate(const SurveyPoints& survey, double max_lag_m = 0.0) {
  SerialExecutor serial;
  auto result = estimate_dimension_structure(survey, {.max_lag_m = max_lag_m}, serial);
  EXPECT_TRUE(result) << result.error().message;
  return result ? *result : DimensionEstimate{};
}

TEST(StructureDimension, PlanesChangeNothing) {
  for (const double noise : {0.0, 0.3}) {
    const Scattered level = rough_survey(600, 2.4, 7, noise);
    const double expected = estimate(level.survey(noise)).dimension;
    for (const double slope : {1.0, -30.0, 300.0}) {
      Scattered tilted = level;
      for (std::size_t i = 0; i < tilted.z.size(); ++i) tilted.z[i] += slope * tilted.x[i] - 0.7 * slope * tilted.y[i];
      // pair sums are of float32 heights
      EXPECT_NEAR(estimate(tilted.survey(noise)).dimension, expected, 1e-5) << slope << " noise " << noise;
    }
  }
}

}  // namespace
}  // namespace scree::fractal
