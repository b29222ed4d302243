#include "fractal/reconstruction/gibbs_level.hpp"

#include <Eigen/Dense>
#include <gtest/gtest.h>
#include <numbers>

#include "core/random.hpp"
#include "fractal/reconstruction/gibbs_rows.hpp"
#include "fractal/reconstruction/normal_rows.hpp"
#include "fractal/reconstruction/relative_pyramid.hpp"
#include "tests/reconstruction/dense_blend.hpp"

namespace scree::fractal {
namespace {

struct SmallLevel {
  GibbsLevel level;
  Eigen::MatrixXd matrix;
  Eigen::VectorXd solution;

  SmallLevel(int rows, int columns, BlendWeights weights, double data_precision) {
    level.weights = weights;
    level.precision.assign(rows, columns, 0.0F);
    level.right.assign(rows, columns, 0.0F);
    matrix = dense_blend(rows, columns, weights);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(rows * columns);
    for (int i = 0; i < rows * columns; i += 2) {
      const auto at = static_cast<std::size_t>(i);
      level.precision[at] = static_cast<float>(data_precision);
      level.right[at] = static_cast<float>(random_normals(3, 1, i, 0)[0]);
      matrix(i, i) += data_precision;
      right(i) = static_cast<double>(level.right[at]);
    }
    level.finish();
    solution = matrix.llt().solve(right);
  }
};

TEST(GibbsLevel, VarianceOfACellGivenTheOthersIsOneOverTheDiagonal) {
  for (const auto& [rows, columns] : {std::pair{1, 1}, {1, 2}, {1, 6}, {2, 2}, {3, 1}, {5, 4}, {7, 9}}) {
    const SmallLevel small(rows, columns, {0.7F, 0.3F}, 2.0);
    for (int i = 0; i < rows * columns; ++i)
      EXPECT_NEAR(small.level.variance[static_cast<std::size_t>(i)], 1.0 / small.matrix(i, i), 1e-6);
  }
}

TEST(GibbsLevel, SweepsWithoutNoiseEndAtTheDenseSolution) {
  for (const auto& [rows, columns] : {std::pair{1, 1}, {1, 2}, {1, 6}, {2, 2}, {3, 1}, {5, 4}, {7, 9}}) {
    const SmallLevel small(rows, columns, {0.7F, 0.3F}, 2.0);
    Grid<float> x(rows, columns, 0.0F);
    for (int sweep = 0; sweep < 200; ++sweep) gibbs_sweep(small.level, nullptr, x);
    for (int i = 0; i < rows * columns; ++i)
      EXPECT_NEAR(x[static_cast<std::size_t>(i)], small.solution(i), 1e-5) << rows << " x " << columns;
  }
}

// 20 000 sweeps of a well-determined field (correlation of successive sweeps below .5, so at least 6 600 effective
// samples): an estimated covariance has standard deviation ≤ √2·max variance/√6600; 5 of them over 78 entries: false
// alarm below 1e-4.
TEST(GibbsLevel, SamplesHaveTheInverseMatrixAsCovariance) {
  constexpr int kRows = 3, kColumns = 4, kCells = kRows * kColumns, kSweeps = 20000;
  const SmallLevel small(kRows, kColumns, {0.5F, 0.1F}, 4.0);
  const Eigen::MatrixXd covariance = small.matrix.inverse();
  Grid<float> x(kRows, kColumns, 0.0F);
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(kCells, kCells);
  for (int sweep = 0; sweep < kSweeps + 50; ++sweep) {
    const SweepNoise noise{9, static_cast<std::uint64_t>(sweep)};
    gibbs_sweep(small.level, &noise, x);
    if (sweep < 50) continue;
    const Eigen::VectorXd error = Eigen::Map<const Eigen::VectorXf>(x.data(), kCells).cast<double>() - small.solution;
    sum += error * error.transpose();
  }
  const double tolerance = 5.0 * std::sqrt(2.0 / 6600.0) * covariance.diagonal().maxCoeff();
  EXPECT_LT((sum / kSweeps - covariance).cwiseAbs().maxCoeff(), tolerance);
}

// 40 000 normals: their mean has standard deviation 1/200, their mean square √2/200, neighbours' products 1/200; 5 of
// them.
TEST(GibbsLevel, NormalsAreStandardAndIndependent) {
  std::vector<float> row(203);
  double mean = 0.0, square = 0.0, neighbours = 0.0, count = 0.0;
  for (int r = 0; r < 200; ++r) {
    normals_row({4, 7}, r, static_cast<int>(row.size()), row.data());
    for (std::size_t c = 0; c + 1 < row.size(); ++c) {
      const auto value = static_cast<double>(row[c]);
      mean += value, square += value * value, neighbours += value * static_cast<double>(row[c + 1]), count += 1.0;
    }
  }
  EXPECT_NEAR(mean / count, 0.0, 5.0 / std::sqrt(count));
  EXPECT_NEAR(square / count, 1.0, 5.0 * std::sqrt(2.0 / count));
  EXPECT_NEAR(neighbours / count, 0.0, 5.0 / std::sqrt(count));
}

TEST(GibbsRows, SweepsWithoutNoiseEndAtTheDenseSolution) {
  for (const auto& [rows, columns] : {std::pair{1, 1}, {1, 2}, {1, 6}, {2, 2}, {3, 1}, {5, 4}, {7, 9}, {4, 23}}) {
    const SmallLevel small(rows, columns, {0.7F, 0.3F}, 2.0);
    GibbsRows sampler(small.level);
    PhaseField phases;
    phases.load(Grid<float>(rows, columns, 0.0F));
    for (int sweep = 0; sweep < 200; ++sweep) sampler.sweep(nullptr, phases);
    Grid<float> x;
    phases.store(x);
    for (int i = 0; i < rows * columns; ++i)
      EXPECT_NEAR(x[static_cast<std::size_t>(i)], small.solution(i), 1e-5) << rows << " x " << columns;
  }
}

// Tolerance as of the scalar sampler.
TEST(GibbsRows, SamplesHaveTheInverseMatrixAsCovariance) {
  constexpr int kRows = 4, kColumns = 5, kCells = kRows * kColumns, kSweeps = 20000;
  const SmallLevel small(kRows, kColumns, {0.5F, 0.1F}, 4.0);
  const Eigen::MatrixXd covariance = small.matrix.inverse();
  GibbsRows sampler(small.level);
  PhaseField phases;
  phases.load(Grid<float>(kRows, kColumns, 0.0F));
  Grid<float> x;
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(kCells, kCells);
  for (int sweep = 0; sweep < kSweeps + 50; ++sweep) {
    const SweepNoise noise{9, static_cast<std::uint64_t>(sweep)};
    sampler.sweep(&noise, phases);
    if (sweep < 50) continue;
    phases.store(x);
    const Eigen::VectorXd error = Eigen::Map<const Eigen::VectorXf>(x.data(), kCells).cast<double>() - small.solution;
    sum += error * error.transpose();
  }
  const double tolerance = 5.0 * std::sqrt(2.0 / 6600.0) * covariance.diagonal().maxCoeff();
  EXPECT_LT((sum / kSweeps - covariance).cwiseAbs().maxCoeff(), tolerance);
}

TEST(NormalBlock, IsBoxMullerOfTheCountersWords) {
  constexpr int kLanes = 37;
  std::vector<float> block(4 * kLanes);
  for (int row = 0; row < 500; ++row) {
    normal_block(5, 9, row, kLanes, block.data());
    for (int i = 0; i < kLanes; ++i) {
      const auto words = random_words(5, 9, i, row);
      for (std::size_t p = 0; p < 2; ++p) {
        const double u = (static_cast<double>(words[2 * p] >> 9) + 0.5) * 0x1p-23;
        const double angle = 2.0 * std::numbers::pi * static_cast<std::int32_t>(words[2 * p + 1]) * 0x1p-32;
        const double radius = std::sqrt(-2.0 * std::log(u));
        const std::size_t at = 2 * p * kLanes + static_cast<std::size_t>(i);
        EXPECT_NEAR(block[at], radius * std::cos(angle), 1e-6 * (radius + 1e-2));
        EXPECT_NEAR(block[at + kLanes], radius * std::sin(angle), 1e-6 * (radius + 1e-2));
      }
    }
  }
}

TEST(RelativePyramid, InterpolationKeepsConstantsAndPlanes) {
  Grid<float> coarse(5, 4), fine(9, 8);
  for (int r = 0; r < 5; ++r)
    for (int c = 0; c < 4; ++c) coarse(r, c) = static_cast<float>(3.0 + 2.0 * r - c);
  interpolate(coarse, fine);
  for (int r = 1; r < 8; ++r)
    for (int c = 1; c < 7; ++c) EXPECT_NEAR(fine(r, c), 3.0 + 2.0 * ((r - 0.5) / 2.0) - (c - 0.5) / 2.0, 1e-5);
  interpolate(Grid<float>(5, 4, 2.5F), fine);
  for (const float value : fine) EXPECT_FLOAT_EQ(value, 2.5F);
}

TEST(RelativePyramid, EveryLevelHoldsAllData) {
  CellSamples samples{Grid<float>(13, 6, NAN), Grid<float>(13, 6, NAN), Grid<std::uint16_t>(13, 6, 0)};
  for (int r = 0; r < 13; r += 3) {
    samples.height_m(r, r % 6) = static_cast<float>(r);
    samples.variance_m2(r, r % 6) = 0.01F * static_cast<float>(r + 1);
  }
  const RelativePyramid pyramid = make_pyramid(samples, {2.5, 0.3}, 0.1, 0.3);
  EXPECT_EQ(pyramid.levels.size(), 4U);  // 13 x 6, 7 x 3, 4 x 2, 2 x 1
  const auto totals = [](const RelativePyramid::Level& level) {
    double weight = 0.0, sum = 0.0;
    for (std::size_t i = 0; i < level.datum.size(); ++i) {
      weight += static_cast<double>(level.gibbs.precision[i]);
      sum += static_cast<double>(level.gibbs.precision[i] * level.datum[i]);
    }
    return std::pair(weight, sum / weight);
  };
  for (const RelativePyramid::Level& level : pyramid.levels) {
    EXPECT_NEAR(totals(level).first / totals(pyramid.levels.front()).first, 1.0, 1e-5);
    EXPECT_NEAR(totals(level).second, 0.0, 1e-4);  // offset: the weighted mean
  }
  EXPECT_NEAR(pyramid.levels[1].gibbs.weights.w1 / pyramid.levels[0].gibbs.weights.w1, 0.5, 1e-6);  // 2^(-2H)
  EXPECT_NEAR(pyramid.levels[1].gibbs.weights.w2 / pyramid.levels[0].gibbs.weights.w2, 0.5, 1e-6);
}

}  // namespace
}  // namespace scree::fractal
