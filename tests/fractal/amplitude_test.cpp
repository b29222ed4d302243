#include "fractal/amplitude.hpp"

#include <cmath>
#include <gtest/gtest.h>

#include "tests/fractal/vecchia_scene.hpp"

namespace scree::fractal {
namespace {

// n = 24 surfaces of 300 points, spacing 1, amplitude 1. Without noise the relative error is 1/√(2·297) = .041 (the
// quadratic form is chi-square); with noise .3 known more, at most twice that. Mean within 4 standard errors and the
// .02 of the 13 neighbours, rms within 1.25 and 4 standard errors: 6e-5 each.
TEST(Amplitude, OfKnownDimensionIsFoundToTheStatisticalLimit) {
  constexpr int kSurfaces = 24;
  for (const double dimension : {2.2, 2.5, 2.8})
    for (const double noise : {0.0, 0.3}) {
      const double bound = 0.041 * (noise > 0.0 ? 2.0 : 1.0);
      double mean = 0.0, square = 0.0;
      for (std::uint64_t seed = 0; seed < kSurfaces; ++seed) {
        const Scattered survey = rough_survey(300, dimension, seed + 70, noise);
        const double error = std::log(*estimate_amplitude(survey.survey(noise), dimension));
        mean += error / kSurfaces, square += error * error / kSurfaces;
      }
      EXPECT_LT(std::abs(mean), 0.02 + 4.0 * bound / std::sqrt(kSurfaces)) << dimension << ", " << noise;
      EXPECT_LT(std::sqrt(square), 1.25 * bound * (1.0 + 4.0 / std::sqrt(2.0 * kSurfaces)))
          << dimension << ", " << noise;
    }
}

TEST(Amplitude, AgreesWithTheEstimatorAtItsOwnDimension) {
  const Scattered survey = rough_survey(500, 2.4, 5);
  const DimensionEstimate both = *estimate_dimension_vecchia(survey.survey());
  EXPECT_NEAR(*estimate_amplitude(survey.survey(), both.dimension) / both.amplitude_m, 1.0, 1e-3);
}

TEST(Amplitude, OfAPlaneIsAnError) {
  Scattered survey = scattered_places(100, 3);
  survey.z = survey.x;
  EXPECT_FALSE(estimate_amplitude(survey.survey(), 2.5));
}

}  // namespace
}  // namespace scree::fractal
