#include "fractal/law_picture.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <vector>

#include "fractal/surface.hpp"

namespace scree::fractal {
namespace {

constexpr int kSide = 100;

/// The law of the ground itself, whatever the tilt.
DimensionEstimate law_of(double dimension, double amplitude_m) {
  DimensionEstimate law;
  law.dimension = dimension;
  law.amplitude_m = amplitude_m;
  return law;
}

// One exact surface, far out a structure function is off by some 10 % (a few independent patches): 4 of those.
TEST(LawPicture, PointsOfTiltedGroundLieOnItsLaw) {
  const auto surface = *fbm_surface({2.4, 0.2}, kSide, kSide, 0.5, 3);
  std::vector<double> x, y, z;
  for (int r = 0; r < kSide; ++r)
    for (int c = 0; c < kSide; ++c) {
      x.push_back(0.5 * c), y.push_back(0.5 * r);
      z.push_back(static_cast<double>(surface(r, c)) + 3.0 * c);
    }
  SerialExecutor executor;
  const DimensionEstimate law = law_of(2.4, 0.2);
  const auto picture = law_picture({.x_m = x, .y_m = y, .z_m = z}, {}, law, &law, executor);
  ASSERT_TRUE(picture) << picture.error().message;
  ASSERT_GT(picture->points.size(), 8u);
  for (std::size_t i = 0; i < picture->points.size(); ++i) {
    const LogLogPoint& p = picture->points[i];
    const double expected = std::log(0.2) + 0.6 * p.log_lag;
    EXPECT_NEAR(p.log_change, expected, p.log_lag < std::log(3.0) ? 0.1 : 0.4) << std::exp(p.log_lag);
    EXPECT_NEAR(picture->log_other[i], expected, 1e-9);  // the same law is straight
  }
}

}  // namespace
}  // namespace scree::fractal
