#include "fractal/reconstruction/sd_map.hpp"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

#include "tests/reconstruction/sparse_scene.hpp"

namespace scree::fractal {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

Grid<float> scattered_variances(int rows, int columns, double density, float variance, std::uint64_t seed = 1) {
  Grid<float> out(rows, columns, kNaN);
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c)
      if (to_uniform(random_words(seed, 3, c, r)[0]) < density) out(r, c) = variance;
  return out;
}

Grid<float> estimate(const Grid<float>& mean_square, int fields, const Grid<float>& variance, const LawMap& law,
                     Executor* executor = nullptr) {
  SerialExecutor serial;
  SdMap map;
  Grid<float> sd;
  map.estimate(mean_square, fields, variance, law, kSceneCellM, executor != nullptr ? *executor : serial, sd);
  return sd;
}

/// σ²·d^(2H) of the law at each cell; `chi_square` of that many degrees of freedom on it, 0 = none.
Grid<float> power_law(const Grid<float>& variance, const LawMap& law, int fields = 0) {
  Grid<std::uint8_t> set(variance.rows(), variance.columns());
  for (std::size_t i = 0; i < set.size(); ++i) set[i] = variance[i] > 0.0F ? 1 : 0;
  SerialExecutor serial;
  DistanceTransform transform;
  Grid<std::int32_t> squared;
  transform.transform(set, serial, squared);
  Grid<float> out(set.rows(), set.columns());
  for (int r = 0; r < set.rows(); ++r)
    for (int c = 0; c < set.columns(); ++c) {
      double chi = fields == 0 ? 1.0 : 0.0;
      for (int k = 0; k < fields; ++k)
        chi += std::pow(random_normals(8, static_cast<std::uint64_t>(k), c, r)[0], 2) / fields;
      const FractalLaw here = law.at(r, c);
      const double sd = here.rms_change_m(kSceneCellM * std::sqrt(std::max(squared(r, c), 1)));
      out(r, c) = static_cast<float>(chi * sd * sd);
    }
  return out;
}

LawMap varying_law(int rows, int columns) {
  LawMap law{{2.4, 0.2}, Grid<float>(rows, columns), Grid<float>(rows, columns)};
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c) {
      law.dimension(r, c) = 2.2F + 0.5F * static_cast<float>(c) / static_cast<float>(columns);
      law.amplitude_m(r, c) = 0.05F * std::exp(2.0F * static_cast<float>(r) / static_cast<float>(rows));
    }
  return law;
}

// What the regression can say exactly it says exactly: float sums leave 1e-3 at most.
TEST(SdMap, APowerOfTheDistanceComesBack) {
  const Grid<float> variance = scattered_variances(100, 140, 0.05, 1e-4F);
  for (const LawMap& law : {LawMap{{2.3, 0.2}, {}, {}}, varying_law(100, 140)}) {
    const Grid<float> v = power_law(variance, law);
    const Grid<float> sd = estimate(v, 8, variance, law);
    for (std::size_t i = 0; i < v.size(); ++i) {
      if (variance[i] > 0.0F) continue;
      ASSERT_NEAR(sd[i] / std::sqrt(v[i]), 1.0, 2e-3) << i;
    }
  }
}

// On the slope from smooth to rough ground the surroundings decide: v = σ²·d^(2H)·exp(0.3·g²), g the change of ln σ²
// over a spacing. The ridge takes 20 of about 500 from the slope, hence 0.3·0.9·20/520/2 = .005 of the sd at the
// steepest; not knowing of it would cost 0.3·0.9/2 = .13.
TEST(SdMap, KnowsHowFastTheLawChanges) {
  const int rows = 100, columns = 140;
  const Grid<float> variance = scattered_variances(rows, columns, 0.05, 1e-4F);
  LawMap law{{2.4, 0.2}, Grid<float>(rows, columns, 2.4F), Grid<float>(rows, columns)};
  double measured = 0.0;
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c) {
      law.amplitude_m(r, c) = static_cast<float>(0.1 * std::pow(5.0, 0.5 + 0.5 * std::erf((c - 70) / 8.8)));
      measured += variance(r, c) > 0.0F ? 1.0 : 0.0;
    }
  const double spacing = std::sqrt(rows * columns / measured);
  const int half = static_cast<int>(std::lround(0.5 * spacing));
  Grid<float> v = power_law(variance, law);
  for (int r = 0; r < rows; ++r)
    for (int c = half; c < columns - half; ++c) {
      const double slope = std::log(static_cast<double>(law.amplitude_m(r, c + half) / law.amplitude_m(r, c - half)));
      v(r, c) *= static_cast<float>(std::exp(0.3 * std::pow(2.0 * slope * spacing / (2.0 * half), 2)));
    }
  const Grid<float> sd = estimate(v, 8, variance, law);
  for (std::size_t i = 0; i < v.size(); ++i) {
    if (variance[i] > 0.0F) continue;
    ASSERT_NEAR(sd[i] / std::sqrt(v[i]), 1.0, 0.008) << i;
  }
}

// χ²(8)/8 in every cell on its own: log sd of a cell errs by .26, of the model by that over √(14000/9 coefficients),
// .007, and of the smoothed ratio, half of it over the 4π·9² cells of two spacings, by .25·√(.25)/32 = .004. Bound 4
// s.e. of their sum.
TEST(SdMap, TakesOutTheNoiseOfTheFields) {
  const Grid<float> variance = scattered_variances(100, 140, 0.05, 1e-4F);
  for (const LawMap& law : {LawMap{{2.3, 0.2}, {}, {}}, varying_law(100, 140)}) {
    const Grid<float> truth = power_law(variance, law), v = power_law(variance, law, 8);
    const Grid<float> sd = estimate(v, 8, variance, law);
    double sum2 = 0.0, n = 0.0;
    for (std::size_t i = 0; i < v.size(); ++i) {
      if (variance[i] > 0.0F) continue;
      sum2 += std::pow(std::log(sd[i] / std::sqrt(truth[i])), 2);
      n += 1.0;
    }
    EXPECT_LT(std::sqrt(sum2 / n), 0.03);
  }
}

// 8 residual fields against 64 others: .09, the published target, and the noise of 64 draws, 1/√128 = .088, make .126.
// Measured cells: R·(1 − R/v') with v' ≈ 1000 R, so the sd is the datum's to .1 %.
TEST(SdMap, EightFieldsSayWhatManySay) {
  const SparseScene scene(2.5, 128, 128, 0.05, 4);
  Grid<float> few(128, 128, 0.0F), many(128, 128, 0.0F);
  SerialExecutor serial;
  Reconstruction out;
  ConditionalReconstructor with({.cell_m = kSceneCellM, .max_cells = 1024});
  for (int k = 0; k < 72; ++k) {  // windows of one torus far apart: the data leave nothing of what they share
    with.reconstruct(scene.height, scene.variance, scene.window({128 * (k % 9), 128 * (k / 9)}), scene.law, serial,
                     out);
    for (std::size_t i = 0; i < few.size(); ++i) {
      const float e = out.draws_m[0][i] - out.mean_m[i];
      (k < 8 ? few[i] : many[i]) += e * e / (k < 8 ? 8.0F : 64.0F);
    }
  }
  const Grid<float> sd = estimate(few, 8, scene.variance, {scene.law, {}, {}});
  double sum2 = 0.0, n = 0.0;
  for (std::size_t i = 0; i < sd.size(); ++i) {
    if (scene.variance[i] > 0.0F) {
      ASSERT_LE(sd[i], 1.0001 * scene.sigma);
      ASSERT_GT(sd[i], 0.99 * scene.sigma);
      continue;
    }
    sum2 += std::pow(std::log(sd[i] / std::sqrt(many[i])), 2);
    n += 1.0;
  }
  EXPECT_LT(std::sqrt(sum2 / n), 0.126);
}

TEST(SdMap, MetresScaleAndThreadsDoNotMatter) {
  class Pieces final : public Executor {
    void for_ranges(int count, const std::function<void(int, int)>& body) override {
      for (int i = count; i > 0; i -= 7) body(std::max(i - 7, 0), i);
    }
  } pieces;
  const LawMap law{{2.6, 0.2}, {}, {}}, law8{{2.6, 1.6}, {}, {}};
  Grid<float> variance = scattered_variances(60, 300, 0.1, 1e-3F), v = power_law(variance, law, 8);
  const Grid<float> sd = estimate(v, 8, variance, law);
  EXPECT_EQ(sd, estimate(v, 8, variance, law, &pieces));
  for (float& x : variance) x *= 64.0F;
  for (float& x : v) x *= 64.0F;
  const Grid<float> sd8 = estimate(v, 8, variance, law8);
  for (std::size_t i = 0; i < sd.size(); ++i) ASSERT_NEAR(sd8[i] / sd[i], 8.0, 0.008);
}

TEST(SdMap, NoDatumLeavesTheLevelUnknown) {
  const Grid<float> sd = estimate(Grid<float>(9, 9, 1.0F), 8, Grid<float>(9, 9, kNaN), {{2.5, 0.2}, {}, {}});
  EXPECT_TRUE(std::all_of(sd.begin(), sd.end(), [](float x) { return std::isnan(x); }));
}

TEST(SdMap, AroundOneDatumItGrowsAsTheLawSays) {
  Grid<float> variance(80, 80, kNaN);
  variance(40, 10) = 1e-4F;
  const LawMap law{{2.4, 0.2}, {}, {}};
  const Grid<float> sd = estimate(power_law(variance, law, 8), 8, variance, law);
  EXPECT_LE(sd(40, 10), 0.0100001F);
  for (const int lag : {5, 20, 60}) EXPECT_NEAR(sd(40, 10 + lag) / law.law.rms_change_m(lag * kSceneCellM), 1.0, 0.1);
}

// Everything measured, R = v': the posterior variance is R/2, and χ²(8)/8 of 1600 cells says so to √(2/8/1600) =
// 1.25 %, the sd to .63 %; bound 4 s.e. Tiny errors of the data: their own.
TEST(SdMap, WithEveryCellMeasuredTheDataDecide) {
  const LawMap law{{2.5, 0.2}, {}, {}};
  Grid<float> v = power_law(Grid<float>(40, 40, 1.0F), law, 8);
  const auto unit2 = static_cast<float>(std::pow(law.law.rms_change_m(kSceneCellM), 2));
  for (float& x : v) x *= 0.5F;
  const Grid<float> sd = estimate(v, 8, Grid<float>(40, 40, unit2), law);
  for (const float x : sd) ASSERT_NEAR(x / std::sqrt(0.5F * unit2), 1.0, 0.025);
  for (float& x : v) x *= 1e-5F;
  for (const float x : estimate(v, 8, Grid<float>(40, 40, 0.5e-5F * unit2), law))
    ASSERT_NEAR(x / std::sqrt(0.5e-5F * unit2), 1.0, 0.01);
}

TEST(SdMap, TakesGridsOfEveryShape) {
  const LawMap law{{2.5, 0.2}, {}, {}};
  for (const auto& [rows, columns] : {std::pair{1, 1}, {1, 40}, {3, 7}, {40, 1}, {257, 30}, {5, 513}}) {
    Grid<float> variance = scattered_variances(rows, columns, 0.3, 1e-4F);
    variance(0, 0) = 1e-4F;
    const Grid<float> sd = estimate(power_law(variance, law, 8), 8, variance, law);
    EXPECT_TRUE(std::all_of(sd.begin(), sd.end(), [](float x) { return x > 0.0F && x < 10.0F; }))
        << rows << " x " << columns;
  }
}

}  // namespace
}  // namespace scree::fractal
