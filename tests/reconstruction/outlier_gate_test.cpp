#include "fractal/reconstruction/outlier_gate.hpp"

#include <cmath>
#include <gtest/gtest.h>

#include "tests/reconstruction/broken_scene.hpp"
#include "tests/reconstruction/outlier_scene.hpp"

namespace scree::fractal {
namespace {

// Data that exact fBm explains: 4 s of the gate are some 5 standard deviations of a residual, for the fit follows its
// data. 3 × 3277 cells: none expected, one allowed at each D.
TEST(OutlierGate, LeavesExactGroundAlone) {
  for (const double dimension : {2.2, 2.5, 2.8}) {
    std::size_t rejected = 0;
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      const SparseScene scene(dimension, 256, 256, 0.05, seed);
      const OutlierReport report = find_outliers(cells_of(scene), kSceneCellM, {scene.law, {}, {}});
      EXPECT_GT(report.tested, 3000U);
      rejected += report.count;
    }
    EXPECT_LE(rejected, 1U) << "D = " << dimension;
  }
}

// 3 % of the data off by 8 … 25 times the change over a cell: the surface is within 3 % of the one of who knows them
// (the published target; 1–2 % measured over many surfaces, docs/reconstruction.md). Ungated it errs twice as much.
TEST(OutlierGate, GatedIsNearlyAsGoodAsTold) {
  for (const double dimension : {2.3, 2.5, 2.7}) {
    double told = 0.0, gated = 0.0, plain = 0.0;
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      const OutlierScene scene(dimension, 256, 256, 0.05, seed);
      const OutlierReport report = find_outliers(scene.samples, kSceneCellM, {scene.law, {}, {}});
      told += std::pow(rmse_of_mean(scene, scene.told), 2);
      plain += std::pow(rmse_of_mean(scene, scene.samples), 2);
      gated += std::pow(rmse_of_mean(scene, without_outliers(scene.samples, report)), 2);
    }
    EXPECT_LT(std::sqrt(gated / told), 1.03) << "D = " << dimension;
    EXPECT_GT(std::sqrt(plain / told), 1.5) << "D = " << dimension;
  }
}

// A cliff of 25 and rocks of 10 … 20 changes over a cell are ground: at most a tenth of the data within four cells of
// their edges may go (3–8 % measured over many scenes), hardly one of the others.
TEST(OutlierGate, CliffsAndRocksStay) {
  const BrokenScene scene(2.5, 256, 256, 0.05, 1);
  const OutlierReport report = find_outliers(cells_of(scene), kSceneCellM, {scene.law, {}, {}});
  int near = 0, near_rejected = 0, away_rejected = 0;
  for (int r = 0; r < 256; ++r)
    for (int c = 0; c < 256; ++c) {
      if (std::isnan(scene.height(r, c))) continue;
      near += scene.near(r, c) ? 1 : 0;
      (scene.near(r, c) ? near_rejected : away_rejected) += report.rejected(r, c);
    }
  EXPECT_GT(report.supported, 10U);
  EXPECT_LT(near_rejected, near / 10);
  EXPECT_LE(away_rejected, 3);
}

TEST(OutlierGate, CountsWhatItTakesOut) {
  const OutlierScene scene(2.5, 100, 120, 0.1, 5);
  const OutlierReport report = find_outliers(scene.samples, kSceneCellM, {scene.law, {}, {}});
  const CellSamples left = without_outliers(scene.samples, report);
  std::size_t cells = 0;
  for (std::size_t i = 0; i < left.height_m.size(); ++i) {
    cells += std::isnan(left.height_m[i]) ? 0 : 1;
    EXPECT_TRUE(report.rejected[i] == 0 || (std::isnan(left.height_m[i]) && std::isnan(left.variance_m2[i])));
  }
  EXPECT_EQ(report.tested, scene.samples.cells);
  EXPECT_EQ(left.cells, cells);
  EXPECT_EQ(left.cells + report.count, report.tested);
}

// A law that is the same everywhere, said cell by cell, is that law; and amplitudes in metres do not matter.
TEST(OutlierGate, AsksTheLawOfTheCell) {
  const OutlierScene scene(2.4, 100, 120, 0.1, 6);
  LawMap map{scene.law, Grid<float>(100, 120, static_cast<float>(scene.law.dimension)),
             Grid<float>(100, 120, static_cast<float>(scene.law.amplitude_m))};
  const OutlierReport one = find_outliers(scene.samples, kSceneCellM, {scene.law, {}, {}});
  EXPECT_EQ(one.rejected, find_outliers(scene.samples, kSceneCellM, map).rejected);
  CellSamples large = scene.samples;
  for (float& z : large.height_m) z = 3.0F * z + 1000.0F;
  for (float& v : large.variance_m2) v *= 9.0F;
  const OutlierReport three = find_outliers(large, kSceneCellM, {{2.4, 3.0 * scene.law.amplitude_m}, {}, {}});
  EXPECT_EQ(one.rejected, three.rejected);
}

TEST(OutlierGate, NoDataNoOutliers) {
  CellSamples none{Grid<float>(9, 9, NAN), Grid<float>(9, 9, NAN), Grid<std::uint16_t>(9, 9, 0)};
  EXPECT_EQ(find_outliers(none, 0.1, {{2.5, 0.2}, {}, {}}).tested, 0U);
  none.height_m(4, 4) = 7.0F;
  none.variance_m2(4, 4) = 1e-3F;
  none.cells = 1;
  const OutlierReport one = find_outliers(none, 0.1, {{2.5, 0.2}, {}, {}});
  EXPECT_EQ(one.tested, 1U);
  EXPECT_EQ(one.count, 0U);
}

}  // namespace
}  // namespace scree::fractal
