#include "drivers/simulator_physics.hpp"

#include <array>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <vector>

#include "core/random.hpp"

namespace scree::drivers {
namespace {

TEST(BeamPhysics, PhaseNoiseHasTheNominalSigma) {
  SensorPhysics physics;
  physics.shot_per_m = 5e-4;
  physics.thermal_per_m2 = 3e-5;
  const BeamEcho echo{5.0, 0.4, 0.5};
  const double sigma = nominal_sigma_m(physics, echo.range_m, echo.reflectance, echo.cos_incidence);
  EXPECT_NEAR(sigma, std::hypot(5e-4 * 5 / std::sqrt(0.2), 3e-5 * 25 / 0.2), 1e-12);
  // n = 40,000: the variance ratio has standard error √(2/n) = 0.7 %; 5 of them, false-alarm rate 6e-7.
  double sum = 0.0;
  for (int i = 0; i < 20000; ++i) {
    const auto a = random_normals(3, 1, i, 0);
    for (const double sign : {0, 1}) {
      const std::array<double, 4> normals{a[static_cast<std::size_t>(sign)], a[1 - static_cast<std::size_t>(sign)], 0,
                                          0};
      const auto reading = read_beam(physics, 8.29, {&echo, 1}, 1, normals);
      sum += std::pow((std::remainder(reading->range_m - 5.0, 8.29)) / sigma, 2);
    }
  }
  EXPECT_NEAR(sum / 40000, 1.0, 5 * std::sqrt(2.0 / 40000));
}

TEST(BeamPhysics, MixedPixelIsThePhaseOfThePhasorSum) {
  SensorPhysics physics;  // no noise
  const std::vector<BeamEcho> echoes{{2.0, 1.0, 0.5}, {4.0, 1.0, 0.5}};
  const double w = 2.0 * std::numbers::pi / 20.0;
  const double expected =
      std::atan2(std::sin(2 * w) / 4 + std::sin(4 * w) / 16, std::cos(2 * w) / 4 + std::cos(4 * w) / 16) / w;
  const auto reading = read_beam(physics, 20.0, echoes, 2, {});
  EXPECT_NEAR(reading->range_m, expected, 1e-12);
  EXPECT_GT(reading->range_m, 2.0);
  EXPECT_LT(reading->range_m, 4.0);
  // Nearly opposite phases: beyond both surfaces.
  const auto beyond = read_beam(physics, 5.0, std::vector<BeamEcho>{{2.0, 1.0, 0.5}, {4.6, 1.0, 0.5}}, 2, {});
  EXPECT_TRUE(beyond->range_m < 2.0 || beyond->range_m > 4.6);
}

TEST(BeamPhysics, ReturnTooFarAwayIsUniformlyRandomInRange) {
  SensorPhysics physics;
  physics.shot_per_m = 5e-4;
  physics.thermal_per_m2 = 3e-5;
  const BeamEcho far{30.0, 1.0, 0.5};
  std::array<int, 8> bins{};
  for (int i = 0; i < 8000; ++i) {
    const auto normals = random_normals(3, 2, i, 0);
    const auto reading = read_beam(physics, 8.0, {&far, 1}, 1, {normals[0], normals[1], 0, 0});
    ++bins[static_cast<std::size_t>(reading->range_m)];
    EXPECT_LT(reading->reflectance, 0.2);
  }
  // χ² with 7 degrees of freedom: above 37.5 with probability 4e-6.
  double chi2 = 0.0;
  for (const int n : bins) chi2 += (n - 1000.0) * (n - 1000.0) / 1000.0;
  EXPECT_LT(chi2, 37.5);
}

TEST(BeamPhysics, PulseTakesTheStrongestGroupAndStereoNeedsHalfTheBeam) {
  SensorPhysics physics;
  physics.principle = RangePrinciple::pulse;
  const std::vector<BeamEcho> echoes{{5.0, 1.0, 0.5}, {5.1, 1.0, 0.5}, {3.0, 0.05, 0.5}};
  EXPECT_NEAR(read_beam(physics, 0.0, echoes, 3, {})->range_m, 5.05, 0.01);
  physics.principle = RangePrinciple::stereo;
  EXPECT_NEAR(read_beam(physics, 0.0, echoes, 3, {})->range_m, 5.05, 1e-9);
  EXPECT_FALSE(read_beam(physics, 0.0, echoes, 9, {}));
}

TEST(BeamPhysics, CrosstalkTableIsInterpolated) {
  SensorPhysics physics;
  physics.crosstalk_m = {0.0, 0.1};
  const BeamEcho echo{2.0, 1.0, 0.25};
  EXPECT_NEAR(read_beam(physics, 8.0, {&echo, 1}, 1, {})->range_m, 2.025, 1e-9);
}

}  // namespace
}  // namespace scree::drivers
