#include "fractal/reconstruction/kriging.hpp"

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "tests/reconstruction/method_scene.hpp"

namespace scree::fractal {
namespace {

constexpr double kUnitM = 0.37;  // rms change over one cell of the small cases

FractalLaw law_of(double hurst) {
  return {3.0 - hurst, kUnitM / std::pow(kSceneCellM, hurst)};
}

struct Datum {
  int row, column;
  double height, noise;  // in units of kUnitM, variance
};

CellSamples samples_of(const std::vector<Datum>& data, int rows, int columns) {
  CellSamples samples = no_cells(rows, columns);
  for (const Datum& d : data) measure(samples, d.row, d.column, kUnitM * d.height, kUnitM * kUnitM * d.noise);
  return samples;
}

struct Answer {
  double mean, deviation;
};

/// What is known of z(cell) − d_0 given the differences d_i − d_0, whose covariances need no constant.
Answer by_differences(const std::vector<Datum>& data, double hurst, int row, int column) {
  const auto half = [hurst](double dy, double dx) { return 0.5 * std::pow(std::hypot(dy, dx), 2.0 * hurst); };
  const auto covariance = [&](int r1, int c1, int r2, int c2) {  // of fBm that is zero at the first datum
    const Datum& o = data[0];
    return half(r1 - o.row, c1 - o.column) + half(r2 - o.row, c2 - o.column) - half(r1 - r2, c1 - c2);
  };
  const auto n = static_cast<Eigen::Index>(data.size()) - 1;
  Eigen::MatrixXd matrix(n, n);
  Eigen::VectorXd difference(n), target(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Datum& a = data[static_cast<std::size_t>(i) + 1];
    for (Eigen::Index j = 0; j < n; ++j) {
      const Datum& b = data[static_cast<std::size_t>(j) + 1];
      matrix(i, j) = covariance(a.row, a.column, b.row, b.column) + data[0].noise + (i == j ? a.noise : 0.0);
    }
    difference(i) = a.height - data[0].height;
    target(i) = covariance(a.row, a.column, row, column) + data[0].noise;
  }
  const Eigen::VectorXd weights = matrix.ldlt().solve(target);
  const double variance = covariance(row, column, row, column) + data[0].noise - weights.dot(target);
  return {data[0].height + weights.dot(difference), std::sqrt(std::max(0.0, variance))};
}

TEST(Kriging, IsTheConditionalMeanAndDeviationOfTheDifferences) {
  SerialExecutor serial;
  const std::vector<Datum> data = {{0, 0, 1.0, 0.01},   {3, 7, -0.5, 0.3}, {8, 2, 2.0, 1e-3},
                                   {8, 3, 1.2, 0.0001}, {5, 11, 0.4, 2.0}, {9, 9, -1.0, 0.05}};
  for (const double hurst : {0.1, 0.5, 0.8}) {
    const auto estimate = reconstruct_kriging(samples_of(data, 10, 13), request_for(law_of(hurst), 10, 13), {}, serial);
    ASSERT_TRUE(estimate);
    for (int r = 0; r < 10; ++r)
      for (int c = 0; c < 13; ++c) {
        const Answer expected = by_differences(data, hurst, r, c);
        EXPECT_NEAR(estimate->mean_m(r, c) / kUnitM, expected.mean, 1e-5);
        EXPECT_NEAR(estimate->sd_m(r, c) / kUnitM, expected.deviation, 1e-5);
      }
  }
}

TEST(Kriging, OneDatumLeavesTheVariogram) {
  SerialExecutor serial;
  const auto estimate =
      reconstruct_kriging(samples_of({{2, 3, 1.5, 0.25}}, 6, 9), request_for(law_of(0.4), 6, 9), {}, serial);
  ASSERT_TRUE(estimate);
  for (int r = 0; r < 6; ++r)
    for (int c = 0; c < 9; ++c) {
      EXPECT_NEAR(estimate->mean_m(r, c), kUnitM * 1.5, 1e-5);
      const double variance = std::pow(std::hypot(r - 2, c - 3), 0.8) + 0.25;
      EXPECT_NEAR(estimate->sd_m(r, c), kUnitM * std::sqrt(variance), 1e-5);
    }
}

TEST(Kriging, MiddleOfTwoExactHeightsIsTheirMeanWithTheMidpointsVariance) {
  SerialExecutor serial;
  for (const double hurst : {0.2, 0.5, 0.9}) {
    const auto estimate = reconstruct_kriging(samples_of({{0, 0, 1.0, 1e-12}, {0, 8, 4.0, 1e-12}}, 1, 9),
                                              request_for(law_of(hurst), 1, 9), {}, serial);
    ASSERT_TRUE(estimate);
    EXPECT_NEAR(estimate->mean_m(0, 4), kUnitM * 2.5, 1e-5);
    const double variance = std::pow(4.0, 2.0 * hurst) * (1.0 - std::exp2(2.0 * hurst - 2.0));
    EXPECT_NEAR(estimate->sd_m(0, 4), kUnitM * std::sqrt(variance), 1e-5);
  }
}

TEST(Kriging, InterpolatesExactHeights) {
  SerialExecutor serial;
  const SparseScene scene(2.4, 40, 30, 0.1, 3);
  CellSamples samples = cells_of(scene);
  const auto unit = static_cast<float>(scene.law.rms_change_m(kSceneCellM));
  for (float& variance : samples.variance_m2) variance *= 1e-6F;
  SurfaceRequest request = request_for(scene, 2);
  std::vector<Grid<float>> draws;
  keep_draws(request, draws);
  const auto estimate = reconstruct_kriging(samples, request, {}, serial);
  ASSERT_TRUE(estimate);
  for (std::size_t i = 0; i < samples.height_m.size(); ++i) {
    if (std::isnan(samples.height_m[i])) continue;
    EXPECT_NEAR(estimate->mean_m[i], samples.height_m[i], 1e-4F * unit);
    EXPECT_NEAR(estimate->sd_m[i], 0.0F, 1e-4F * unit);
    EXPECT_NEAR(draws[1][i], samples.height_m[i], 3e-4F * unit);
  }
}

// 20 surfaces, each with some 115 data: errors of cells between the same data go together, so about 115 independent
// ones a surface, 2300 in all. Standard deviation of the coverage √(.09/2300) = .0063, of the mean normalised square
// √(2/2300) = .029: 4 of them, false alarm 6e-5 each.
TEST(Kriging, NinetyPercentIntervalsHoldNinetyPercentOfTheTruth) {
  SerialExecutor serial;
  for (const double dimension : {2.2, 2.5, 2.8}) {
    PredictionScore score;
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
      const SparseScene scene(dimension, 48, 48, 0.05, seed);
      const auto estimate = reconstruct_kriging(cells_of(scene), request_for(scene, 0), {}, serial);
      ASSERT_TRUE(estimate);
      score += score_prediction(scene.truth, estimate->mean_m, estimate->sd_m, 1.0,
                                [&](int r, int c) { return std::isnan(scene.height(r, c)); });
    }
    EXPECT_NEAR(score.coverage(), 0.90, 0.025) << dimension;
    EXPECT_NEAR(score.normalised / score.cells, 1.0, 0.12) << dimension;
  }
}

// 400 draws: their mean has a standard error of sd/20, their variance one of √(2/400) = .071; 120 cells, 4.5 and 5
// standard errors: false alarm 1e-3 and below.
TEST(Kriging, DrawsHaveItsMeanAndDeviation) {
  SerialExecutor serial;
  const SparseScene scene(2.6, 10, 12, 0.1, 2, 0.3);
  constexpr int kDraws = 400;
  SurfaceRequest request = request_for(scene, kDraws);
  std::vector<Grid<float>> draws;
  keep_draws(request, draws);
  const auto estimate = reconstruct_kriging(cells_of(scene), request, {}, serial);
  ASSERT_TRUE(estimate);
  ASSERT_EQ(draws.size(), static_cast<std::size_t>(kDraws));
  for (std::size_t i = 0; i < scene.truth.size(); ++i) {
    const double mean_m = static_cast<double>(estimate->mean_m[i]), sd_m = static_cast<double>(estimate->sd_m[i]);
    double sum = 0.0, square = 0.0;
    for (const Grid<float>& draw : draws) {
      sum += static_cast<double>(draw[i]) - mean_m;
      square += std::pow(static_cast<double>(draw[i]) - mean_m, 2);
    }
    EXPECT_NEAR(sum / kDraws / sd_m, 0.0, 4.5 / 20.0);
    EXPECT_NEAR(square / kDraws / (sd_m * sd_m), 1.0, 5.0 * 0.071);
  }
}

TEST(Kriging, ResultsDependOnTheSeedAlone) {
  SerialExecutor serial;
  BackwardExecutor backward;
  const SparseScene scene(2.3, 21, 34, 0.1, 4);
  SurfaceRequest request = request_for(scene, 6);
  std::vector<Grid<float>> first, second;
  keep_draws(request, first);
  const auto a = reconstruct_kriging(cells_of(scene), request, {}, serial);
  keep_draws(request, second);
  const auto b = reconstruct_kriging(cells_of(scene), request, {}, backward);
  ASSERT_TRUE(a && b);
  EXPECT_EQ(a->mean_m, b->mean_m);
  EXPECT_EQ(a->sd_m, b->sd_m);
  EXPECT_EQ(first, second);
}

TEST(Kriging, SaysWhatItCannotHold) {
  SerialExecutor serial;
  const auto message = [&](const CellSamples& samples, const SurfaceRequest& request, const KrigingOptions& options) {
    const auto result = reconstruct_kriging(samples, request, options, serial);
    EXPECT_FALSE(result);
    return result ? std::string() : result.error().message;
  };
  const SparseScene scene(2.5, 20, 20, 0.5, 1);
  const CellSamples samples = cells_of(scene);
  EXPECT_EQ(message(samples, request_for(scene), {.max_samples = 100}),
            "kriging: expected at most 100 measured cells (it is dense), found " + std::to_string(samples.cells));
  EXPECT_TRUE(message(samples, request_for(scene), {.max_bytes = 100000})
                  .starts_with("kriging: expected to fit in 0 MB, found " + std::to_string(samples.cells)));
  EXPECT_EQ(message(no_cells(5, 5), request_for({2.5, 0.2}, 5, 5), {}),
            "kriging: expected at least 1 measured cell in 5 x 5, found 0");
  SurfaceRequest varying = request_for(scene);
  varying.law.dimension.assign(20, 20, 2.5F);
  varying.law.amplitude_m.assign(20, 20, 0.2F);
  EXPECT_TRUE(message(samples, varying, {}).starts_with("kriging: expected one D and one amplitude"));
}

}  // namespace
}  // namespace scree::fractal
