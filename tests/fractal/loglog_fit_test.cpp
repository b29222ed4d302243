#include "fractal/loglog_fit.hpp"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <vector>

#include "core/random.hpp"
#include "fractal/surface.hpp"

namespace scree::fractal {
namespace {

/// Slopes .7 over points 0 … 11, .3 over 11 … 23.
std::vector<LogLogPoint> broken_line() {
  std::vector<LogLogPoint> points;
  for (int i = 0; i < 24; ++i) {
    const double x = 0.2 * i, knee = 0.2 * 11;
    points.push_back({x, -1.0 + 0.7 * std::min(x, knee) + 0.3 * std::max(0.0, x - knee), 100.0});
  }
  return points;
}

std::vector<LogLogPoint> noisy_line(std::uint64_t seed, int count) {
  std::vector<LogLogPoint> points;
  for (int i = 0; i < count; ++i) {
    const auto words = random_words(seed, 9, i, 0);
    points.push_back({i + 0.8 * to_uniform(words[0]), 0.5 * i + to_uniform(words[1]), 100.0});
  }
  return points;
}

TEST(LogLogFit, PolylineFindsTheKnee) {
  const auto segments = linear_segments(broken_line(), Segmentation::polyline, 1e-9);
  ASSERT_EQ(segments.size(), 2u);
  EXPECT_EQ(segments[0].first, 0);
  EXPECT_EQ(segments[0].last, 11);
  EXPECT_NEAR(segments[0].slope, 0.7, 1e-12);
  EXPECT_EQ(segments[1].first, 11);
  EXPECT_EQ(segments[1].last, 23);
  EXPECT_NEAR(segments[1].slope, 0.3, 1e-12);
}

TEST(LogLogFit, BothSegmentationsReportTheFirstPartAndItsScales) {
  for (const Segmentation segmentation : {Segmentation::polyline, Segmentation::least_squares}) {
    const auto found = log_log_dimension(broken_line(), Moment::second, segmentation, 1e-9);
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->dimension, 2.3, 1e-12);
    EXPECT_NEAR(found->amplitude_m, std::exp(-1.0), 1e-12);
    EXPECT_EQ(found->points, 12);
    EXPECT_NEAR(found->lag_min_m, 1.0, 1e-12);
    EXPECT_NEAR(found->lag_max_m, std::exp(2.2), 1e-12);
  }
}

TEST(LogLogFit, AWiderToleranceRunsPastTheKnee) {
  int before = 0;
  for (const double tolerance : {1e-9, 0.01, 0.05, 0.2, 1.0}) {
    const auto segments = linear_segments(broken_line(), Segmentation::polyline, tolerance);
    EXPECT_GE(segments[0].last, before);
    EXPECT_LE(segments[0].largest_residual, tolerance);
    before = segments[0].last;
  }
  EXPECT_EQ(before, 23);
}

// Helly: the smallest largest residual of a set is that of its worst triple, half the vertical distance of the middle
// point from the chord.
TEST(LogLogFit, MinimaxLineIsTheBestOfAllLines) {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    const auto points = noisy_line(seed, 9);
    double worst = 0.0;
    for (std::size_t a = 0; a < points.size(); ++a)
      for (std::size_t b = a + 1; b < points.size(); ++b)
        for (std::size_t c = b + 1; c < points.size(); ++c) {
          const double t = (points[b].log_lag - points[a].log_lag) / (points[c].log_lag - points[a].log_lag);
          const double chord = points[a].log_change + t * (points[c].log_change - points[a].log_change);
          worst = std::max(worst, 0.5 * std::abs(points[b].log_change - chord));
        }
    const auto segments = linear_segments(points, Segmentation::polyline, 10.0);
    ASSERT_EQ(segments.size(), 1u);
    EXPECT_NEAR(segments[0].largest_residual, worst, 1e-12);
    double found = 0.0;
    for (const auto& p : points)
      found = std::max(found, std::abs(p.log_change - segments[0].intercept - segments[0].slope * p.log_lag));
    EXPECT_NEAR(found, worst, 1e-12);
  }
}

TEST(LogLogFit, LeastSquaresPassesOverAFaultyStart) {
  auto points = broken_line();
  points[0].log_change += 2.0;
  const auto found = log_log_dimension(points, Moment::second, Segmentation::least_squares, 1e-6);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->dimension, 2.3, 1e-9);
  EXPECT_EQ(found->segments[0].first, 1);
}

// Normal equations written out: weights 1/d² are e^(−2·log_lag).
TEST(LogLogFit, WeightsMoveTheLineTowardsShortDistances) {
  const auto points = broken_line();
  double s = 0.0, sx = 0.0, sy = 0.0, sxx = 0.0, sxy = 0.0;
  for (const auto& p : points) {
    const double w = std::exp(-2.0 * p.log_lag);
    s += w, sx += w * p.log_lag, sy += w * p.log_change, sxx += w * p.log_lag * p.log_lag,
        sxy += w * p.log_lag * p.log_change;
  }
  const double slope = (s * sxy - sx * sy) / (s * sxx - sx * sx);
  constexpr double kAnything = 10.0;
  const auto weighted =
      log_log_dimension(points, Moment::second, Segmentation::least_squares, kAnything, LineWeights::inverse_square);
  ASSERT_TRUE(weighted);
  EXPECT_EQ(weighted->points, 24);
  EXPECT_NEAR(weighted->dimension, 3.0 - slope, 1e-12);
  const auto equal = log_log_dimension(points, Moment::second, Segmentation::least_squares, kAnything);
  EXPECT_LT(std::abs(weighted->dimension - 2.3), std::abs(equal->dimension - 2.3));
}

TEST(LogLogFit, SaysWhenNothingIsStraight) {
  std::vector<LogLogPoint> zigzag;
  for (int i = 0; i < 10; ++i) zigzag.push_back({0.1 * i, i % 2 == 0 ? 0.0 : 1.0, 100.0});
  for (const Segmentation segmentation : {Segmentation::polyline, Segmentation::least_squares}) {
    const auto found = log_log_dimension(zigzag, Moment::second, segmentation, 0.01);
    ASSERT_FALSE(found);
    EXPECT_EQ(found.error().kind, ErrorKind::bad_data);
  }
  EXPECT_FALSE(log_log_dimension({}, Moment::second, Segmentation::polyline));
}

// On a line z = g·x, |dz| = g·d. A moment's root exceeds g times the geometric mean distance by a factor between 1 and
// e^(w²), w the half-width in nepers; the slope of a fit then errs by at most w²/2 · Σ|x − x̄| / Σ(x − x̄)².
TEST(LogLogFit, APlaneHasDimensionTwoAndItsSlopeForAmplitude) {
  PointColumns points;
  for (int i = 0; i < 4000; ++i) points.push_back(0.01F * static_cast<float>(i), 0.0F, 0.003F * static_cast<float>(i));
  SerialExecutor serial;
  const Annuli annuli = geometric_annuli(0.1, 1.2, 10.0);
  const auto statistics = structure_function(points, annuli, {.route = PairRoute::all_pairs}, serial);
  ASSERT_TRUE(statistics);
  for (const Moment moment : {Moment::first_absolute, Moment::second}) {
    const auto plot = log_log_points(*statistics, moment);
    ASSERT_EQ(plot.size(), static_cast<std::size_t>(annuli.count));
    double mean = 0.0, spread = 0.0, spread2 = 0.0;
    for (const auto& p : plot) mean += p.log_lag / static_cast<double>(plot.size());
    for (const auto& p : plot) spread += std::abs(p.log_lag - mean), spread2 += std::pow(p.log_lag - mean, 2);
    const double excess = annuli.half_width * annuli.half_width;
    const auto found = log_log_dimension(plot, moment, Segmentation::polyline, excess);
    ASSERT_TRUE(found);
    EXPECT_EQ(found->points, annuli.count);
    EXPECT_LE(std::abs(found->dimension - 2.0), 0.5 * excess * spread / spread2);
    const double gaussian = moment == Moment::second ? 1.0 : std::sqrt(std::acos(-1.0) / 2.0);
    EXPECT_NEAR(found->amplitude_m, 0.3 * gaussian, 0.3 * gaussian * 2.0 * excess);
  }
}

// The statistics of n = 40 surfaces are added: expectations are those of the law, so D is unbiased but for the variance
// of a logarithm. Bound: 4 standard errors from the surfaces' own spread, 8 cases: false-alarm rate 8 · 3e-4.
TEST(LogLogFit, EnsemblesOfExactSurfacesHaveTheirDimension) {
  constexpr int kSurfaces = 40;
  SerialExecutor serial;
  const Annuli annuli = uniform_annuli(0.1, 1.2);
  for (const double dimension : {2.2, 2.5, 2.8})
    for (const Moment moment : {Moment::first_absolute, Moment::second}) {
      StructureFunction total{annuli, std::vector<PairSums>(static_cast<std::size_t>(annuli.count))};
      double sum = 0.0, sum2 = 0.0, amplitude = 0.0, amplitude2 = 0.0;
      for (int i = 0; i < kSurfaces; ++i) {
        const auto z = *fbm_surface({dimension, 0.2}, 40, 40, 0.1, 300 + static_cast<std::uint64_t>(i));
        PointColumns points;
        for (int r = 0; r < 40; ++r)
          for (int c = 0; c < 40; ++c)
            points.push_back(0.1F * static_cast<float>(c), 0.1F * static_cast<float>(r), z(r, c));
        const auto one = structure_function(points, annuli, {}, serial);
        ASSERT_TRUE(one);
        for (std::size_t k = 0; k < total.sums.size(); ++k) {
          total.sums[k].count += one->sums[k].count;
          total.sums[k].abs_m += one->sums[k].abs_m;
          total.sums[k].square_m2 += one->sums[k].square_m2;
          total.sums[k].log_m += one->sums[k].log_m;
        }
        const auto d = log_log_dimension(log_log_points(*one, moment), moment, Segmentation::polyline, 9.0);
        sum += d->dimension, sum2 += d->dimension * d->dimension;
        amplitude += std::log(d->amplitude_m), amplitude2 += std::pow(std::log(d->amplitude_m), 2);
      }
      const auto error = [](double s, double s2) {
        return std::sqrt((s2 / kSurfaces - s * s / kSurfaces / kSurfaces) / (kSurfaces - 1));
      };
      const auto found = log_log_dimension(log_log_points(total, moment), moment, Segmentation::polyline, 9.0);
      ASSERT_TRUE(found);
      EXPECT_LT(std::abs(found->dimension - dimension), 4.0 * error(sum, sum2)) << "D = " << dimension;
      EXPECT_LT(std::abs(std::log(found->amplitude_m / 0.2)), 4.0 * error(amplitude, amplitude2))
          << "D = " << dimension;
    }
}

TEST(LogLogFit, SkipsThinAnnuliAndRoutesWithoutTheMoment) {
  StructureFunction statistics{uniform_annuli(1.0, 3.0), {{100, 50, 30, 0}, {5, 3, 2, 4}, {100, 0, 0, 110}}, true};
  EXPECT_EQ(log_log_points(statistics, Moment::second).size(), 1u);
  EXPECT_EQ(log_log_points(statistics, Moment::second, 1).size(), 2u);
  EXPECT_EQ(log_log_points(statistics, Moment::first_absolute)[0].log_change, std::log(0.5));
  statistics.has_absolute = false;
  EXPECT_TRUE(log_log_points(statistics, Moment::first_absolute).empty());
}

}  // namespace
}  // namespace scree::fractal
