#include "fractal/reconstruction/line_process.hpp"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

#include "fractal/reconstruction/blend_prior.hpp"
#include "fractal/reconstruction/break_inflation.hpp"
#include "tests/reconstruction/broken_scene.hpp"

namespace scree::fractal {
namespace {

/// The scene's data in units of the change over a cell, fitted without breaks.
BlendFit plain_fit(const SparseScene& scene, double density) {
  const int rows = scene.height.rows(), columns = scene.height.columns();
  const double unit = scene.law.rms_change_m(kSceneCellM), dimension = scene.law.dimension;
  BlendFit fit(rows, columns);
  fit.prior().uniform = blend_weights(dimension, blend_wavenumber(dimension, 1.0 / std::sqrt(density)));
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c)
      if (!std::isnan(scene.height(r, c)))
        fit.set_datum(r, c, static_cast<float>(static_cast<double>(scene.height(r, c)) / unit),
                      static_cast<float>(unit * unit / static_cast<double>(scene.variance(r, c))));
  fit.solve(0.02);
  return fit;
}

double rmse_away(const BlendFit& fit, const SparseScene& scene, const Grid<std::int32_t>* edge2 = nullptr) {
  const double unit = scene.law.rms_change_m(kSceneCellM);
  double sum2 = 0.0, n = 0.0;
  for (int r = 0; r < scene.height.rows(); ++r)
    for (int c = 0; c < scene.height.columns(); ++c) {
      if (!std::isnan(scene.height(r, c)) || (edge2 != nullptr && (*edge2)(r, c) <= 16)) continue;
      sum2 += std::pow(static_cast<double>(fit.row(r)[c]) - static_cast<double>(scene.truth(r, c)) / unit, 2);
      n += 1.0;
    }
  return std::sqrt(sum2 / n);
}

// Two plates 30 changes apart, a third of the cells known to 1 %: between known neighbours the step is where it is.
TEST(LineProcess, BreaksAStepAndNothingElse) {
  constexpr int kRows = 40, kColumns = 60, kStep = 30;
  BlendFit fit(kRows, kColumns);
  fit.prior().uniform = blend_weights(2.5, 0.65);
  for (int r = 0; r < kRows; ++r)
    for (int c = 0; c < kColumns; ++c)
      if (to_uniform(random_words(1, 1, c, r)[0]) < 0.33 || c == kStep - 1 || c == kStep)
        fit.set_datum(r, c, c < kStep ? 0.0F : 30.0F, 1e4F);
  fit.solve(0.02);
  break_edges(fit, {});
  for (int r = 0; r < kRows; ++r) {
    EXPECT_FLOAT_EQ(fit.prior().right.row(r)[kStep - 1], 0.02F);
    for (int c = 0; c < kColumns; ++c) {
      EXPECT_TRUE(c + 1 == kStep || fit.prior().right.row(r)[c] > 0.95F) << r << ' ' << c;
      EXPECT_GT(fit.prior().down.row(r)[c], 0.95F) << r << ' ' << c;
      EXPECT_NEAR(fit.row(r)[c], c < kStep ? 0.0F : 30.0F, 0.2F) << r << ' ' << c;
    }
  }
}

// On ground that has no breaks their price is a percent of RMSE; the mean of 5 % data is smoother than its law, so
// hardly an edge reaches τ = 3 changes over a cell.
TEST(LineProcess, CostsLittleWhereThereIsNothingToBreak) {
  for (const double dimension : {2.3, 2.7}) {
    const SparseScene scene(dimension, 192, 192, 0.05, 2);
    BlendFit fit = plain_fit(scene, 0.05);
    const double plain = rmse_away(fit, scene);
    break_edges(fit, {});
    EXPECT_LT(rmse_away(fit, scene), 1.01 * plain) << "D = " << dimension;
  }
}

// Away from cliffs and rocks the surface gets better: it no longer bends towards them.
TEST(LineProcess, CliffsStopBendingTheGroundBeside) {
  const BrokenScene scene(2.3, 256, 256, 0.05, 1);
  BlendFit fit = plain_fit(scene, 0.05);
  const double plain = rmse_away(fit, scene, &scene.edge2);
  break_edges(fit, {});
  EXPECT_LT(rmse_away(fit, scene, &scene.edge2), plain);
}

TEST(LineProcess, TheChangeOfTheCellIsTheUnit) {
  const BrokenScene scene(2.5, 64, 80, 0.1, 3);
  BlendFit fit = plain_fit(scene, 0.1), same = fit, tripled(64, 80);
  tripled.prior().uniform = {fit.prior().uniform.w1 / 9.0F, fit.prior().uniform.w2 / 9.0F};
  for (int r = 0; r < 64; ++r)
    for (int c = 0; c < 80; ++c)
      if (fit.precision(r, c) > 0.0F) tripled.set_datum(r, c, 3.0F * fit.height(r, c), fit.precision(r, c) / 9.0F);
  tripled.solve(0.02);
  break_edges(fit, {});
  break_edges(same, Grid<float>(64, 80, 1.0F));
  break_edges(tripled, Grid<float>(64, 80, 3.0F));
  for (int r = 0; r < 64; ++r)
    for (int c = 0; c < 80; ++c) {
      ASSERT_EQ(fit.row(r)[c], same.row(r)[c]);
      ASSERT_NEAR(3.0F * fit.row(r)[c], tripled.row(r)[c], 0.1F);
    }
}

TEST(BreakInflation, IsOneWhereNothingBreaks) {
  const SparseScene scene(2.5, 96, 96, 0.1, 4);
  BlendFit fit = plain_fit(scene, 0.1);
  fit.prior().right.resize(fit.shape().rows, fit.shape().columns);
  fit.prior().down.resize(fit.shape().rows, fit.shape().columns);
  for (int r = 0; r < fit.shape().rows; ++r) {
    std::fill_n(fit.prior().right.row(r), fit.shape().columns, 1.0F);
    std::fill_n(fit.prior().down.row(r), fit.shape().columns, 1.0F);
  }
  const Grid<float> factor = break_inflation(fit, Grid<float>(96, 96, 1.0F), 0.5, {});
  EXPECT_TRUE(std::all_of(factor.begin(), factor.end(), [](float q) { return q == 1.0F; }));
}

// Data left out beside a cliff of 25 are missed by some 10 units where the law says 1.3: factors of tens there.
TEST(BreakInflation, GrowsBesideCliffsOnly) {
  const BrokenScene scene(2.5, 128, 128, 0.1, 5);
  BlendFit fit = plain_fit(scene, 0.1);
  break_edges(fit, {});
  const Grid<float> factor = break_inflation(fit, Grid<float>(128, 128, 1.7F), 0.5, {});
  double near = 0.0, near_cells = 0.0, away = 0.0, away_cells = 0.0;
  for (int r = 0; r < 128; ++r)
    for (int c = 0; c < 128; ++c) {
      EXPECT_GE(factor(r, c), 1.0F);
      const bool at = scene.near(r, c), far = scene.edge2(r, c) > 144;
      near += at ? static_cast<double>(factor(r, c)) : 0.0, near_cells += at ? 1.0 : 0.0;
      away += far ? static_cast<double>(factor(r, c)) : 0.0, away_cells += far ? 1.0 : 0.0;
    }
  EXPECT_GT(near / near_cells, 5.0);
  EXPECT_LT(away / away_cells, 1.1);
}

}  // namespace
}  // namespace scree::fractal
