// Membrane, thin plate, and midpoints between regular samples.

#include <Eigen/Dense>
#include <gtest/gtest.h>
#include <numbers>

#include "fractal/reconstruction/spline.hpp"
#include "fractal/reconstruction/yokoya.hpp"
#include "tests/reconstruction/dense_blend.hpp"
#include "tests/reconstruction/method_scene.hpp"

namespace scree::fractal {
namespace {

using Spline = Result<SurfaceEstimate> (*)(const CellSamples&, const SurfaceRequest&, Executor&);

/// Minimum of the energy with the whole weight on one order; sides that the multigrid does not pad.
Eigen::VectorXd dense_spline(bool plate, const SparseScene& scene) {
  const int rows = scene.height.rows(), columns = scene.height.columns();
  const double unit = scene.law.rms_change_m(kSceneCellM), count = static_cast<double>(cells_of(scene).cells);
  const double k0 = blend_wavenumber(scene.law.dimension, std::sqrt(static_cast<double>(scene.height.size()) / count));
  const BlendWeights blend = blend_weights(scene.law.dimension, k0);
  const double total = static_cast<double>(blend.w1) * k0 * k0 + static_cast<double>(blend.w2) * std::pow(k0, 4);
  const Eigen::MatrixXd l = grid_laplacian(rows, columns);
  Eigen::MatrixXd matrix = plate ? Eigen::MatrixXd(total / std::pow(k0, 4) * l * l) : total / (k0 * k0) * l;
  Eigen::VectorXd right = Eigen::VectorXd::Zero(matrix.rows());
  for (int i = 0; i < matrix.rows(); ++i) {
    const auto at = static_cast<std::size_t>(i);
    if (std::isnan(scene.height[at])) continue;
    const double c = unit * unit / static_cast<double>(scene.variance[at]);
    matrix(i, i) += c;
    right(i) = c * static_cast<double>(scene.height[at]);
  }
  return matrix.llt().solve(right);
}

// Float right-hand sides of 1000 and r·z < 1e-6 · cells: 1e-3 of the change over a cell.
TEST(Spline, AgreesWithADenseSolve) {
  SerialExecutor serial;
  for (const double dimension : {2.2, 2.5, 2.8})
    for (const bool plate : {false, true}) {
      const SparseScene scene(dimension, 24, 28, 0.06, 2);
      const auto estimate =
          (plate ? reconstruct_thin_plate : reconstruct_membrane)(cells_of(scene), request_for(scene), serial);
      ASSERT_TRUE(estimate);
      EXPECT_TRUE(estimate->converged);
      EXPECT_TRUE(std::isnan(estimate->sd_m[0]));
      const Eigen::VectorXd expected = dense_spline(plate, scene);
      const double unit = scene.law.rms_change_m(kSceneCellM);
      double worst = 0.0;
      for (int i = 0; i < expected.size(); ++i)
        worst =
            std::max(worst, std::abs(static_cast<double>(estimate->mean_m[static_cast<std::size_t>(i)]) - expected(i)));
      EXPECT_LT(worst, 2e-3 * unit) << dimension << (plate ? " thin plate, " : " membrane, ") << estimate->iterations;
    }
}

TEST(Spline, OneDatumMakesALevelSurfaceOfAnyShape) {
  SerialExecutor serial;
  for (const Spline method : {reconstruct_membrane, reconstruct_thin_plate})
    for (const auto& [rows, columns] : {std::pair{1, 1}, {1, 40}, {37, 53}}) {
      CellSamples samples = no_cells(rows, columns);
      measure(samples, rows / 3, columns / 2, -2.5, 1e-6);
      const auto estimate = method(samples, request_for({2.4, 0.3}, rows, columns), serial);
      ASSERT_TRUE(estimate);
      for (const float value : estimate->mean_m) EXPECT_NEAR(value, -2.5F, 1e-4F);
    }
}

TEST(Spline, DrawsAreTheMean) {
  SerialExecutor serial;
  const SparseScene scene(2.5, 16, 16, 0.2, 1);
  SurfaceRequest request = request_for(scene, 2);
  std::vector<Grid<float>> draws;
  keep_draws(request, draws);
  const auto estimate = reconstruct_membrane(cells_of(scene), request, serial);
  ASSERT_TRUE(estimate);
  ASSERT_EQ(draws.size(), 2U);
  EXPECT_EQ(draws[1], estimate->mean_m);
}

TEST(Spline, BadInputIsNamed) {
  SerialExecutor serial;
  EXPECT_EQ(reconstruct_membrane(no_cells(3, 3), request_for({2.5, 0.2}, 3, 3), serial).error().message,
            "membrane: expected at least 1 measured cell in 3 x 3, found 0");
  EXPECT_EQ(reconstruct_thin_plate(no_cells(3, 3), request_for({1.5, 0.2}, 3, 3), serial).error().message,
            "thin-plate: expected 2 < D < 3, found D = 1.5");
}

struct LatticeScene {
  FractalLaw law;
  Grid<float> truth;
  CellSamples samples;

  LatticeScene(double dimension, int rows, int columns, int first_row, int first_column, int step, std::uint64_t seed)
      : law{dimension, kSceneAmplitudeM},
        truth(*fbm_surface(law, rows, columns, kSceneCellM, seed)),
        samples(no_cells(rows, columns)) {
    for (int r = first_row; r < rows; r += step)
      for (int c = first_column; c < columns; c += step) measure(samples, r, c, static_cast<double>(truth(r, c)), 1e-6);
  }
  SurfaceRequest request(int draws) const { return request_for(law, truth.rows(), truth.columns(), draws); }
};

TEST(Yokoya, KeepsItsSamplesAndFillsTheLatticeAndNothingElse) {
  SerialExecutor serial;
  for (const int step : {1, 2, 8}) {
    const LatticeScene scene(2.5, 30, 45, 2, 5, step, 1);
    SurfaceRequest request = scene.request(1);
    std::vector<Grid<float>> draws;
    keep_draws(request, draws);
    const auto estimate = reconstruct_yokoya(scene.samples, request, serial);
    ASSERT_TRUE(estimate) << estimate.error().message;
    const int last_row = 2 + (29 - 2) / step * step, last_column = 5 + (44 - 5) / step * step;
    for (int r = 0; r < 30; ++r)
      for (int c = 0; c < 45; ++c) {
        const bool inside = r >= 2 && r <= last_row && c >= 5 && c <= last_column;
        EXPECT_EQ(std::isnan(draws[0](r, c)), !inside) << r << ' ' << c;
        EXPECT_EQ(std::isnan(estimate->sd_m(r, c)), !inside);
        if (!std::isnan(scene.samples.height_m(r, c))) {
          EXPECT_EQ(draws[0](r, c), scene.samples.height_m(r, c));
          EXPECT_EQ(estimate->sd_m(r, c), 0.0F);
        }
      }
  }
}

TEST(Yokoya, WithoutNoiseAPlaneStaysOneInside) {
  SerialExecutor serial;
  const auto plane = [](int r, int c) { return 0.5F * static_cast<float>(r) - 0.25F * static_cast<float>(c); };
  LatticeScene scene(2.5, 17, 17, 0, 0, 4, 1);
  for (int r = 0; r < 17; ++r)
    for (int c = 0; c < 17; ++c)
      if (!std::isnan(scene.samples.height_m(r, c))) scene.samples.height_m(r, c) = plane(r, c);
  const auto estimate = reconstruct_yokoya(scene.samples, scene.request(0), serial);
  ASSERT_TRUE(estimate);
  for (int r = 4; r < 13; ++r)
    for (int c = 4; c < 13; ++c) EXPECT_NEAR(estimate->mean_m(r, c), plane(r, c), 1e-5F);
}

// The first centre gets √(1 − 2^(2H−2))·σ·δ^H of noise; variance of 4000 draws: ± √(2/4000) = 2.2 %, 4.5 of them.
TEST(Yokoya, CentresAreDisplacedByThePapersVariance) {
  SerialExecutor serial;
  const LatticeScene scene(2.3, 3, 3, 0, 0, 2, 1);
  const auto estimate = reconstruct_yokoya(scene.samples, scene.request(4000), serial);
  ASSERT_TRUE(estimate);
  const double change = scene.law.rms_change_m(std::numbers::sqrt2 * kSceneCellM);
  EXPECT_NEAR(std::pow(estimate->sd_m(1, 1) / change, 2), 1.0 - std::exp2(1.4 - 2.0), 0.1 * 0.34);
}

// D^ − D* of one draw of step-4 samples: .020, .039, .032 at D = 2.3, 2.5, 2.7 over many surfaces, ± .01 from one to
// the next.
TEST(Yokoya, DrawsAreAboutAsRoughAsTheGround) {
  SerialExecutor serial;
  for (const auto& [dimension, expected] : {std::pair{2.3, 0.020}, {2.5, 0.039}, {2.7, 0.032}}) {
    const LatticeScene scene(dimension, 257, 257, 0, 0, 4, 5);
    SurfaceRequest request = scene.request(1);
    std::vector<Grid<float>> draws;
    keep_draws(request, draws);
    ASSERT_TRUE(reconstruct_yokoya(scene.samples, request, serial));
    EXPECT_NEAR(axis_dimension(draws[0]) - axis_dimension(scene.truth), expected, 0.04) << dimension;
  }
}

TEST(Yokoya, WhatIsNoLatticeIsSaid) {
  SerialExecutor serial;
  const auto message = [&](const LatticeScene& scene) {
    const auto result = reconstruct_yokoya(scene.samples, scene.request(1), serial);
    EXPECT_FALSE(result);
    const std::string text = result ? "" : result.error().message;
    return text.substr(text.rfind("found"));
  };
  EXPECT_EQ(message(LatticeScene(2.5, 20, 20, 0, 0, 3, 1)), "found a step of 3 rows");
  LatticeScene gap(2.5, 20, 20, 1, 3, 4, 1);
  gap.samples.height_m(5, 7) = NAN;
  EXPECT_EQ(message(gap), "found none in row 5, column 7");
  LatticeScene extra(2.5, 20, 20, 1, 3, 4, 1);
  measure(extra.samples, 6, 7, 0.0, 1e-6);
  EXPECT_EQ(message(extra), "found rows 5 and 6 after a step of 4");
  LatticeScene oblong(2.5, 20, 20, 0, 0, 4, 1);
  for (int r = 0; r < 20; r += 4)
    for (int c = 4; c < 20; c += 8) oblong.samples.height_m(r, c) = NAN;
  EXPECT_EQ(message(oblong), "found columns 0 and 8 beside a step of 4 rows");
  LatticeScene one(2.5, 20, 20, 8, 8, 16, 1);
  EXPECT_EQ(message(one), "found them in 1 rows and 1 columns");
}

}  // namespace
}  // namespace scree::fractal
