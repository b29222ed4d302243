// The noise of the heights estimated beside D.

#include <cmath>
#include <gtest/gtest.h>
#include <string>

#include "fractal/noise_check.hpp"
#include "tests/fractal/vecchia_scene.hpp"

namespace scree::fractal {
namespace {

DimensionEstimate with_unknown_noise(const Scattered& survey) {
  SurveyPoints points = survey.survey();
  points.noise_unknown = true;
  return *estimate_dimension_vecchia(points);
}

double width(const Interval& interval) {
  return interval.high - interval.low;
}

// n = 24 surfaces of 1000 points, D = 2.4, noise .3. Cramér–Rao bounds from the dense Fisher information (plane
// unknown): D .0540 (noise known: .0351), noise .0393. RMSE: 1.25 times the bound and 4 standard errors; bias: a third
// of the bound and 4 standard errors; coverage: at least .91 (100 surfaces of the bench: .93) − 4·√(.91·.09/24) = .68;
// the mean interval is wider than with known noise by 1.2 at least (the bounds say 1.54). False alarms: 3e-5 each.
TEST(VecchiaNoise, IsFoundBesideDimension) {
  constexpr int kSurfaces = 24;
  constexpr double kBound = 0.0540, kNoiseBound = 0.0393;
  Scattered survey = scattered_places(1000, 31);
  const auto truth = *FbmPoints::make({2.4, 1.0}, survey.x, survey.y);
  double bias = 0.0, square = 0.0, noise_bias = 0.0, noise_square = 0.0, covered = 0.0, free_width = 0.0,
         width_known = 0.0;
  for (std::uint64_t seed = 0; seed < kSurfaces; ++seed) {
    survey.z = truth.draw(seed);
    add_noise_and_tilt(survey, 0.3, 0.5, seed);
    const DimensionEstimate found = with_unknown_noise(survey);
    EXPECT_TRUE(found.noise_estimated);
    bias += (found.dimension - 2.4) / kSurfaces;
    square += std::pow(found.dimension - 2.4, 2) / kSurfaces;
    noise_bias += (found.noise_sigma_m - 0.3) / kSurfaces;
    noise_square += std::pow(found.noise_sigma_m - 0.3, 2) / kSurfaces;
    covered += found.interval95.low <= 2.4 && 2.4 <= found.interval95.high ? 1.0 / kSurfaces : 0.0;
    free_width += width(found.interval95);
    width_known += width(estimate_dimension_vecchia(survey.survey(0.3))->interval95);
  }
  const double mean = 1.0 / 3.0 + 4.0 / std::sqrt(kSurfaces), spread = 1.25 * (1.0 + 4.0 / std::sqrt(2.0 * kSurfaces));
  EXPECT_LT(std::abs(bias), mean * kBound);
  EXPECT_LT(std::sqrt(square), spread * kBound);
  EXPECT_LT(std::abs(noise_bias), mean * kNoiseBound);
  EXPECT_LT(std::sqrt(noise_square), spread * kNoiseBound);
  EXPECT_GT(covered, 0.68);
  EXPECT_GT(free_width, 1.2 * width_known);
}

// One surface, D = 2.2. The bound of the noise is .022 at .3 and no larger without; it is positive by definition: 4
// times.
TEST(VecchiaNoise, OfCleanGroundIsFoundSmall) {
  const DimensionEstimate found = with_unknown_noise(rough_survey(1000, 2.2, 32));
  EXPECT_LT(found.noise_sigma_m, 4.0 * 0.022);
  EXPECT_LT(found.interval95.low, 2.2);
  EXPECT_GT(found.interval95.high, 2.2);
}

TEST(VecchiaNoise, UnknownItLeavesPlanesAndScalesAlone) {
  const Scattered survey = rough_survey(1000, 2.4, 33, 0.3);
  const DimensionEstimate expected = with_unknown_noise(survey);
  Scattered other = survey;
  for (std::size_t i = 0; i < other.z.size(); ++i)
    other.z[i] = 10.0 * other.z[i] + 30.0 * other.x[i] - 7.0 * other.y[i];
  const DimensionEstimate found = with_unknown_noise(other);
  EXPECT_NEAR(found.dimension, expected.dimension, 1e-6);
  EXPECT_NEAR(found.noise_sigma_m / expected.noise_sigma_m, 10.0, 1e-4);
  EXPECT_NEAR(found.amplitude_m / expected.amplitude_m, 10.0, 1e-4);
}

// White noise and ground of D = 3 are one thing: nothing is known of D, and that is said.
TEST(VecchiaNoise, AloneSaysNothingOfDimension) {
  for (std::uint64_t seed = 0; seed < 3; ++seed) {
    Scattered survey = scattered_places(1000, 34 + seed);
    survey.z.assign(1000, 0.0);
    add_noise_and_tilt(survey, 1.0, 0.5, seed);
    const DimensionEstimate found = with_unknown_noise(survey);
    EXPECT_TRUE(found.flags & kNoiseHides);
    EXPECT_GT(width(found.interval95), 0.5);
  }
}

// Heights that are their noise and nothing else, and the noise told: any D with an amplitude small enough will do. What
// the likelihood prefers among them is chance, so no value is given; a side that chance closes (5 %) may leave one.
TEST(VecchiaNoise, KnownAndAllThereIsLeavesNoDimension) {
  int hidden = 0;
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    Scattered survey = scattered_places(400, 40 + seed);
    survey.z.assign(400, 0.0);
    add_noise_and_tilt(survey, 1.0, 0.5, seed);
    const DimensionEstimate found = *estimate_dimension_vecchia(survey.survey(1.0));
    const bool open = (found.flags & kOpenBelow) && (found.flags & kOpenAbove);
    hidden += open;
    EXPECT_EQ(open, std::isnan(found.dimension)) << seed;
    EXPECT_EQ(open, std::isnan(found.amplitude_m)) << seed;
    EXPECT_TRUE(found.flags & kNoiseHides) << seed;
  }
  EXPECT_GE(hidden, 1);
}

TEST(VecchiaNoise, IsRefusedBelowAThousandPointsAndWhenGivenAsWell) {
  SurveyPoints few;
  const Scattered survey = rough_survey(999, 2.4, 35), enough = rough_survey(1000, 2.4, 35);
  few = survey.survey();
  few.noise_unknown = true;
  const auto refused = estimate_dimension_vecchia(few);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().kind, ErrorKind::bad_data);
  EXPECT_NE(refused.error().message.find("1000 places"), std::string::npos) << refused.error().message;
  EXPECT_NE(refused.error().message.find("found 999"), std::string::npos) << refused.error().message;
  SurveyPoints both = enough.survey(0.3);
  both.noise_unknown = true;
  EXPECT_FALSE(estimate_dimension_vecchia(both));
}

// Pure ground with noise: the part at twice the spacing is judged with the noise of the whole. False alarms: 1e-3 (3.3
// σ).
TEST(VecchiaNoise, UnknownItStillComparesScales) {
  const Scattered survey = rough_survey(1500, 2.5, 36, 0.2);
  const DimensionEstimate found = with_unknown_noise(survey);
  EXPECT_FALSE(found.flags & kScaleDependent);
  EXPECT_TRUE(std::isfinite(found.coarse_dimension));
  EXPECT_GE(found.coarse_spacing_m, 1.9 * found.spacing_m);
}

/// check_noise of `surfaces` surfaces of 1000 points whose noise is `noise`, told `told`.
std::vector<NoiseCheck> checks(double dimension, double noise, double told, int surfaces) {
  Scattered survey = scattered_places(1000, 31);
  const auto truth = *FbmPoints::make({dimension, 1.0}, survey.x, survey.y);
  std::vector<NoiseCheck> out;
  for (int seed = 0; seed < surfaces; ++seed) {
    survey.z = truth.draw(static_cast<std::uint64_t>(seed));
    add_noise_and_tilt(survey, noise, 0.5, static_cast<std::uint64_t>(seed));
    const SurveyPoints points = survey.survey(told);
    out.push_back(*check_noise(points, *estimate_dimension_vecchia(points)));
  }
  return out;
}

// Told right, the statistic is chi-square with 1 degree of freedom: mean 1, standard deviation √2. n = 40: its mean
// lies within 4 · √(2/40) = .9 (6e-5), and more than 2 of 40 beyond a point with probability .001 are 1e-5.
TEST(VecchiaNoise, ARightOneIsNotContradicted) {
  double mean = 0.0;
  int flagged = 0;
  for (const NoiseCheck& check : checks(2.4, 0.3, 0.3, 40)) {
    mean += check.chi_square / 40;
    flagged += check.too_large || check.too_small;
  }
  EXPECT_NEAR(mean, 1.0, 0.9);
  EXPECT_LE(flagged, 2);
}

// D = 2.3: mean statistic 130 for .3 told .6; all of 30 such surfaces, and all of 30 clean ones told .3, were noticed.
TEST(VecchiaNoise, TooMuchOfItIsNoticed) {
  for (const double noise : {0.0, 0.3})
    for (const NoiseCheck& check : checks(2.3, noise, noise == 0.0 ? 0.3 : 0.6, 4)) {
      EXPECT_TRUE(check.too_large) << noise << ": " << check.chi_square;
      EXPECT_FALSE(check.too_small);
    }
}

TEST(VecchiaNoise, TooLittleOfItIsNoticed) {
  for (const NoiseCheck& check : checks(2.1, 0.3, 0.15, 4)) {  // mean statistic 57 of 30 surfaces
    EXPECT_TRUE(check.too_small) << check.chi_square;
    EXPECT_GT(check.free.noise_sigma_m, 0.2);
  }
}

}  // namespace
}  // namespace scree::fractal
