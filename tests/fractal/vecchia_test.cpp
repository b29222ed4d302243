#include "fractal/vecchia.hpp"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <numeric>
#include <string>

#include "fractal/vecchia_lanes.hpp"
#include "fractal/vecchia_neighbours.hpp"
#include "fractal/vecchia_points.hpp"
#include "fractal/vecchia_profile.hpp"
#include "fractal/wide_lanes.hpp"
#include "tests/fractal/vecchia_scene.hpp"

namespace scree::fractal {
namespace {

TEST(WideLanes, LogarithmAndPowerAreExactTo1e14) {
  for (int i = -2000; i < 2000; ++i) {
    const double x = std::exp2(0.0371 * i + 1e-4);
    WideLanes in = {x, x, x, x, x, x, x, x}, out;
    log2_of(in, out);
    EXPECT_NEAR(out[3], std::log2(x), 1e-14 * std::max(1.0, std::abs(std::log2(x))));
    const double y = 0.0371 * i;
    in = WideLanes{} + y;
    exp2_of(in, out);
    EXPECT_NEAR(out[5] / std::exp2(y), 1.0, 1e-14);
  }
}

TEST(Predecessors, AreTheNearestBeforeEachPoint) {
  for (const bool clustered : {false, true}) {
    std::vector<VecchiaPoint> points;
    const Scattered places = scattered_places(700, 3);
    for (std::size_t i = 0; i < places.x.size(); ++i) {
      const double pull = clustered ? std::exp(-0.02 * static_cast<double>(i % 500)) : 1.0;
      points.push_back({places.x[i] * pull, places.y[i] * pull, 0.0, 1.0});
    }
    if (clustered) points[50].x = 1e5;  // one point far away
    const auto found = nearest_predecessors(points);
    for (std::size_t i = 1; i < points.size(); ++i) {
      std::vector<std::int32_t> order(i);
      std::iota(order.begin(), order.end(), 0);
      const auto distance = [&](std::int32_t j) {
        const auto& p = points[static_cast<std::size_t>(j)];
        return std::pow(p.x - points[i].x, 2) + std::pow(p.y - points[i].y, 2);
      };
      std::sort(order.begin(), order.end(), [&](auto a, auto b) { return distance(a) < distance(b); });
      for (std::size_t k = 0; k < std::min<std::size_t>(i, kVecchiaNeighbours); ++k)
        ASSERT_EQ(found[i][k], order[k]) << "point " << i << " neighbour " << k;
    }
  }
}

// As long as every predecessor is a neighbour, nothing is approximated: the likelihood is the exact one.
TEST(Vecchia, IsExactWhereAllPredecessorsAreNeighbours) {
  constexpr Eigen::Index kCount = kVecchiaNeighbours + 1;
  const Scattered survey = rough_survey(kCount, 2.4, 5, 0.2);
  std::vector<VecchiaPoint> points;
  Eigen::MatrixXd xyz(kCount, 3);
  Eigen::VectorXd share(kCount);
  for (Eigen::Index i = 0; i < kCount; ++i) {
    const auto at = static_cast<std::size_t>(i);
    share[i] = i % 3 == 0 ? 0.5 : 1.0;
    points.push_back({survey.x[at], survey.y[at], survey.z[at], share[i]});
    xyz.row(i) << survey.x[at], survey.y[at], survey.z[at];
  }
  const auto predecessors = nearest_predecessors(points);
  const HurstLanes lanes{0.1, 0.055};
  for (const double tau : {0.0, 0.01, 1.0}) {
    PerLane taus;
    taus.fill(tau);
    ErrorSums sums;
    add_errors(points, predecessors, lanes, {&taus, 1}, {&sums, 1});
    const LaneProfile profile = clean_profile(lanes, sums, points.size());
    const double offset = profile.minus_two_log[0] - exact_reml(xyz, lanes.at(0), tau, share);
    for (int k = 1; k < kHurstLanes; ++k)
      EXPECT_NEAR(profile.minus_two_log[static_cast<std::size_t>(k)] - exact_reml(xyz, lanes.at(k), tau, share), offset,
                  1e-7)
          << "H = " << lanes.at(k) << ", tau = " << tau;
  }
}

// n = 40 sets of 60 points a D. Vecchia loses at most 10 % in standard deviation against the exact estimator (0.85/√60
// = .11 for D ≤ 2.4), so the difference of the two has at most √(1.1² − 1) · .11 = .050. Mean and root mean square of
// 40 differences: 4 standard errors, .032 (+ a bias of at most .02) and .050·(1 + 4/√80) = .073; false alarms 1e-4
// each.
TEST(Vecchia, AgreesWithTheExactLikelihood) {
  for (const double dimension : {2.2, 2.5, 2.8}) {
    double sum = 0.0, sum2 = 0.0;
    constexpr int kSets = 40;
    for (std::uint64_t seed = 0; seed < kSets; ++seed) {
      const Scattered survey = rough_survey(60, dimension, 100 + seed);
      Eigen::MatrixXd xyz(60, 3);
      for (Eigen::Index i = 0; i < 60; ++i) {
        const auto at = static_cast<std::size_t>(i);
        xyz.row(i) << survey.x[at], survey.y[at], survey.z[at];
      }
      const Eigen::VectorXd share = Eigen::VectorXd::Ones(60);
      double best = 0.02, least = std::numeric_limits<double>::infinity();
      for (double hurst = 0.02; hurst < 0.99; hurst += 0.01)
        if (const double f = exact_reml(xyz, hurst, 0.0, share); f < least) least = f, best = hurst;
      const auto estimate = estimate_dimension_vecchia(survey.survey());
      ASSERT_TRUE(estimate);
      const double difference = estimate->dimension - (3.0 - best);
      sum += difference;
      sum2 += difference * difference;
    }
    EXPECT_LT(std::abs(sum / kSets), 0.052) << dimension;
    EXPECT_LT(std::sqrt(sum2 / kSets), 0.073) << dimension;
  }
}

TEST(Vecchia, PlanesChangeNothing) {
  for (const double noise : {0.0, 0.3})
    for (const std::size_t count : {100U, 1500U}) {
      const Scattered level = rough_survey(count, 2.4, 7, noise);
      const double expected = estimate_dimension_vecchia(level.survey(noise))->dimension;
      for (const double slope : {1.0, -30.0, 1000.0}) {
        Scattered tilted = level;
        for (std::size_t i = 0; i < tilted.z.size(); ++i)
          tilted.z[i] += slope * tilted.x[i] - 0.7 * slope * tilted.y[i] + slope;
        EXPECT_NEAR(estimate_dimension_vecchia(tilted.survey(noise))->dimension, expected, 1e-6)
            << slope << " noise " << noise << " points " << count;
      }
    }
}

TEST(Vecchia, ScalingHeightsAndNoiseScalesTheAmplitudeAlone) {
  for (const double noise : {0.0, 0.3}) {
    Scattered survey = rough_survey(200, 2.3, 8, noise);
    const auto expected = *estimate_dimension_vecchia(survey.survey(noise));
    for (double& z : survey.z) z *= 10.0;
    const auto scaled = *estimate_dimension_vecchia(survey.survey(10.0 * noise));
    EXPECT_NEAR(scaled.dimension, expected.dimension, 1e-6);
    EXPECT_NEAR(scaled.amplitude_m / expected.amplitude_m, 10.0, 1e-5);
  }
}

TEST(Vecchia, UnitOfLengthAndLargeOffsetsChangeNothing) {
  const Scattered survey = rough_survey(200, 2.3, 9);
  const auto expected = *estimate_dimension_vecchia(survey.survey());
  Scattered moved = survey;
  for (std::size_t i = 0; i < moved.x.size(); ++i)
    moved.x[i] = 4.0 * moved.x[i] + 524288.0, moved.y[i] = 4.0 * moved.y[i] + 4194304.0;
  const auto found = *estimate_dimension_vecchia(moved.survey());
  EXPECT_NEAR(found.dimension, expected.dimension, 1e-5);
  EXPECT_NEAR(found.amplitude_m * std::pow(4.0, 3.0 - found.dimension) / expected.amplitude_m, 1.0, 1e-4);
}

TEST(Vecchia, OrderOfThePointsChangesNothing) {
  Scattered survey = rough_survey(150, 2.6, 10);
  const auto expected = *estimate_dimension_vecchia(survey.survey());
  std::reverse(survey.x.begin(), survey.x.end());
  std::reverse(survey.y.begin(), survey.y.end());
  std::reverse(survey.z.begin(), survey.z.end());
  EXPECT_EQ(estimate_dimension_vecchia(survey.survey())->dimension, expected.dimension);
}

struct Accuracy {
  double bias = 0.0, rmse = 0.0, coverage = 0.0, log_amplitude = 0.0;
};

Accuracy accuracy(std::size_t count, double dimension, double noise, int sets, int draws) {
  Accuracy out;
  for (int set = 0; set < sets; ++set) {
    Scattered survey = scattered_places(count, static_cast<std::uint64_t>(set));
    const auto truth = *FbmPoints::make({dimension, 1.0}, survey.x, survey.y);
    for (int draw = 0; draw < draws; ++draw) {
      const auto seed = static_cast<std::uint64_t>(1000 * set + draw);
      survey.z = truth.draw(seed);
      add_noise_and_tilt(survey, noise, 0.5, seed);
      const auto estimate = *estimate_dimension_vecchia(survey.survey(noise));
      const double error = estimate.dimension - dimension;
      out.bias += error;
      out.rmse += error * error;
      out.coverage += estimate.interval95.low <= dimension && dimension <= estimate.interval95.high ? 1.0 : 0.0;
      out.log_amplitude += std::log(estimate.amplitude_m);
    }
  }
  const double n = sets * draws;
  return {out.bias / n, std::sqrt(out.rmse / n), out.coverage / n, out.log_amplitude / n};
}

// n = 200 surfaces of 100 points a case. RMSE: target · (1 + 4/√400). Bias: half the target for D ≥ 2.2, and 4 standard
// errors. Coverage: at least .93 (that of a long run) − 4·√(.93·.07/200) = .86. False alarms: 3e-5 each, six cases.
TEST(Vecchia, HundredPointsAreJudgedAsWellAsPossible) {
  struct Case {
    double dimension, noise, target;
  };
  for (const auto& [dimension, noise, target] : {Case{2.2, 0.0, .095}, Case{2.6, 0.0, .082}, Case{2.8, 0.0, .068},
                                                 Case{2.2, 0.3, .14}, Case{2.6, 0.3, .11}, Case{2.8, 0.3, .08}}) {
    const Accuracy found = accuracy(100, dimension, noise, 10, 20);
    EXPECT_LT(found.rmse, 1.2 * target) << dimension << " noise " << noise;
    EXPECT_LT(std::abs(found.bias), 0.5 * target + 4.0 * target / std::sqrt(200.0)) << dimension << " noise " << noise;
    EXPECT_GT(found.coverage, 0.86) << dimension << " noise " << noise;
  }
}

// n = 24 surfaces of 1500 points, enough for the zoom. Cramér–Rao bound for D = 2.5: .014·√(3277/1500) = .0207; RMSE
// 1.25 times that, and 4 standard errors; amplitude (at one spacing): standard error of its logarithm some .03 a
// surface.
TEST(Vecchia, ManyPointsAreZoomedInto) {
  const Accuracy found = accuracy(1500, 2.5, 0.0, 3, 8);
  EXPECT_LT(found.rmse, 1.25 * 0.0207 * (1.0 + 4.0 / std::sqrt(48.0)));
  EXPECT_LT(std::abs(found.bias), 0.01 + 4.0 * 0.0207 / std::sqrt(24.0));
  EXPECT_LT(std::abs(found.log_amplitude), 0.01 + 4.0 * 0.03 / std::sqrt(24.0));
}

TEST(Vecchia, AccurateSensorOnRoughGroundIsAsGoodAsNone) {
  const Scattered survey = rough_survey(100, 2.5, 12);
  const auto clean = *estimate_dimension_vecchia(survey.survey());
  for (const double noise : {1e-9, 1e-5, 1e-3})
    EXPECT_NEAR(estimate_dimension_vecchia(survey.survey(noise))->dimension, clean.dimension, 2e-3) << noise;
}

TEST(Vecchia, NoiseThatHidesTheGroundIsSaid) {
  Scattered survey = scattered_places(100, 13);
  survey.z.assign(100, 0.0);
  add_noise_and_tilt(survey, 1.0, 0.5, 13);
  const auto estimate = estimate_dimension_vecchia(survey.survey(1.5));
  ASSERT_TRUE(estimate);
  EXPECT_TRUE(estimate->flags & kNoiseHides);
  EXPECT_TRUE(estimate->flags & kOpenBelow);
  EXPECT_TRUE(estimate->flags & kOpenAbove);
}

TEST(Vecchia, HorizontalNoiseCountsThroughTheSlope) {
  Scattered survey = rough_survey(200, 2.5, 14);
  for (std::size_t i = 0; i < survey.z.size(); ++i) survey.z[i] += 3.0 * survey.y[i];
  SurveyPoints points = survey.survey();
  points.noise_xy_sigma_m = 0.1;
  const auto estimate = *estimate_dimension_vecchia(points);
  EXPECT_NEAR(estimate.noise_sigma_m, 0.1 * 3.0, 0.1);  // the ground has a slope of its own
  EXPECT_FALSE(estimate.flags & kHorizontalNoise);
  points.noise_xy_sigma_m = 0.4;
  EXPECT_TRUE(estimate_dimension_vecchia(points)->flags & kHorizontalNoise);
}

TEST(Vecchia, DuplicatesAreAveragedAndSaid) {
  Scattered survey = rough_survey(100, 2.4, 15);
  const auto expected = *estimate_dimension_vecchia(survey.survey());
  for (std::size_t i = 0; i < 30; ++i) {
    survey.x.push_back(survey.x[i]);
    survey.y.push_back(survey.y[i]);
    survey.z.push_back(survey.z[i]);
  }
  const auto found = *estimate_dimension_vecchia(survey.survey());
  EXPECT_EQ(found.points, 100U);
  EXPECT_EQ(found.duplicates, 30U);
  EXPECT_TRUE(found.flags & kDuplicatesMerged);
  EXPECT_NEAR(found.dimension, expected.dimension, 1e-9);
}

std::string refusal(const Scattered& survey, double noise = 0.0) {
  const auto estimate = estimate_dimension_vecchia(survey.survey(noise));
  if (estimate) return "accepted";
  EXPECT_EQ(estimate.error().kind, ErrorKind::bad_data);
  return estimate.error().message;
}

// Waves much longer than the spacing: H at its bound, where −2 log L falls all the way and has no parabola.
TEST(Vecchia, SigmaIsThatOfTheClosedSideWhereTheOtherIsOpen) {
  Scattered survey = scattered_places(600, 19);
  survey.z.clear();
  for (std::size_t i = 0; i < survey.x.size(); ++i)
    survey.z.push_back(std::sin(0.2 * survey.x[i]) * std::cos(0.17 * survey.y[i]));
  const DimensionEstimate found = *estimate_dimension_vecchia(survey.survey());
  ASSERT_TRUE(found.flags & kOpenBelow);
  ASSERT_FALSE(found.flags & kOpenAbove);
  EXPECT_NEAR(1.96 * found.sigma, found.interval95.high - found.dimension, 1e-3 * found.sigma);
}

TEST(Vecchia, RefusesWhatHasNoDimension) {
  const Scattered good = rough_survey(100, 2.4, 16);
  EXPECT_NE(refusal(rough_survey(19, 2.4, 16)).find("at least 20 points, found 19"), std::string::npos);
  EXPECT_EQ(refusal(rough_survey(20, 2.4, 16)), "accepted");
  Scattered bad = good;
  bad.z[7] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(refusal(bad).find("at point 7"), std::string::npos);
  bad = good;
  std::fill(bad.z.begin(), bad.z.end(), 3.5);
  EXPECT_NE(refusal(bad).find("all equal"), std::string::npos);
  for (std::size_t i = 0; i < bad.z.size(); ++i) bad.z[i] = 0.3 * bad.x[i] - 2.0 * bad.y[i];
  EXPECT_NE(refusal(bad).find("a plane has no D"), std::string::npos);
  bad = good;
  for (std::size_t i = 0; i < bad.y.size(); ++i) bad.y[i] = 2.0 * bad.x[i];
  EXPECT_NE(refusal(bad).find("on one line"), std::string::npos);
  bad = good;
  for (std::size_t i = 0; i < bad.x.size(); ++i) bad.x[i] = bad.x[i % 5], bad.y[i] = bad.y[i % 5];
  EXPECT_NE(refusal(bad).find("at 20 places"), std::string::npos);
  EXPECT_NE(refusal(good, -1.0).find("noise"), std::string::npos);
  bad = good;
  bad.x.pop_back();
  EXPECT_NE(refusal(bad).find("as many x and y"), std::string::npos);
}

// n = 4000 draws of 8 points, all 28 pairs: each mean square is C r^2H to 4·√(2/4000); false alarms 28 · 6e-5.
TEST(FbmPoints, MeanSquareChangesAreThePowerLaw) {
  const Scattered places = scattered_places(8, 17);
  const FractalLaw law{2.3, 0.2};
  const auto truth = FbmPoints::make(law, places.x, places.y);
  ASSERT_TRUE(truth);
  constexpr int kDraws = 4000;
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(8, 8);
  for (int i = 0; i < kDraws; ++i) {
    const auto z = truth->draw(static_cast<std::uint64_t>(i));
    for (std::size_t a = 0; a < 8; ++a)
      for (std::size_t b = 0; b < a; ++b)
        sum(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(b)) += std::pow(z[a] - z[b], 2) / kDraws;
  }
  for (std::size_t a = 0; a < 8; ++a)
    for (std::size_t b = 0; b < a; ++b) {
      const double lag = std::hypot(places.x[a] - places.x[b], places.y[a] - places.y[b]);
      EXPECT_NEAR(sum(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(b)) / std::pow(law.rms_change_m(lag), 2),
                  1.0, 4.0 * std::sqrt(2.0 / kDraws));
    }
  EXPECT_FALSE(FbmPoints::make({2.0, 1.0}, places.x, places.y));
  const std::vector<double> same(8, 1.0);
  EXPECT_FALSE(FbmPoints::make(law, same, same));
}

}  // namespace
}  // namespace scree::fractal
