#include "fractal/reconstruction/szeliski.hpp"

#include <gtest/gtest.h>

#include "fractal/reconstruction/blend_prior.hpp"
#include "tests/reconstruction/method_scene.hpp"

namespace scree::fractal {
namespace {

constexpr Temperature kZero{Temperature::Kind::fixed, 0.0};

TEST(Temperature, ReadsNamesAndNumbers) {
  EXPECT_EQ(parse_temperature("empirical")->kind, Temperature::Kind::empirical);
  EXPECT_EQ(parse_temperature("formula")->kind, Temperature::Kind::formula);
  EXPECT_EQ(parse_temperature("closed-form")->kind, Temperature::Kind::closed_form);
  EXPECT_EQ(parse_temperature("0")->value_m2, 0.0);
  EXPECT_EQ(parse_temperature("2.5e-3")->value_m2, 2.5e-3);
  for (const char* bad : {"", "hot", "-1", "nan", "inf", "1 ", "1x", "closed form"})
    EXPECT_FALSE(parse_temperature(bad)) << bad;
}

TEST(Temperature, ClosedFormIsThatOfTheBlendThatMatchesTheFractalsSpectrum) {
  for (const double dimension : {2.1, 2.5, 2.9}) {
    const BlendWeights blend = blend_weights(dimension, kSzeliskiWavenumber);
    const double temperature = relative_temperature({}, {dimension, 0.4}, 0.1);
    EXPECT_NEAR((dimension - 2.0) / 4.0 / temperature / static_cast<double>(blend.w1), 1.0, 1e-6);
    EXPECT_NEAR((3.0 - dimension) / 16.0 / temperature / static_cast<double>(blend.w2), 1.0, 1e-6);
  }
}

TEST(Temperature, ThePapersTwoLawsAgreeWhereItFixesOneByTheOther) {
  const FractalLaw law{2.4, 0.2};
  const double table = relative_temperature({Temperature::Kind::empirical, 0.0}, law, 0.1);
  EXPECT_NEAR(relative_temperature({Temperature::Kind::formula, 0.0}, law, 0.1) / table, 1.0, 0.02);
  const double sigma0 = law.rms_change_m(0.1);
  EXPECT_NEAR(relative_temperature({Temperature::Kind::fixed, 0.5 * sigma0 * sigma0}, law, 0.1), 0.5, 1e-12);
}

// D^ of a draw − D^ of the truth, 256 × 256, 5 %: .050, .025, −.047 at D = 2.3, 2.5, 2.7 over many surfaces, scattering
// by less than .01 from one surface to the next; T = 0: −.15, −.28, −.36, scattering by .02.
TEST(Szeliski, DrawsAreAsRoughAsTheClosedFormMakesThemAndRelaxationIsTooSmooth) {
  struct Case {
    double dimension, draw, relaxed;
  };
  SerialExecutor serial;
  for (const auto& [dimension, draw, relaxed] : {Case{2.3, .050, -.15}, {2.5, .025, -.28}, {2.7, -.047, -.36}}) {
    const SparseScene scene(dimension, 256, 256, 0.05, 11);
    const double truth = axis_dimension(scene.truth);
    SurfaceRequest request = request_for(scene);
    std::vector<Grid<float>> draws;
    keep_draws(request, draws);
    const auto estimate = reconstruct_szeliski(cells_of(scene), request, {.sweeps = 10}, serial);
    ASSERT_TRUE(estimate);
    ASSERT_EQ(draws.size(), 1U);
    EXPECT_NEAR(axis_dimension(draws[0]) - truth, draw, 0.03) << dimension;
    EXPECT_NEAR(axis_dimension(estimate->mean_m) - truth, relaxed, 0.06) << dimension;
    EXPECT_EQ(estimate->iterations, 10 * 8);
  }
}

TEST(Szeliski, DrawsKeepToTheDataWithinTheirNoise) {
  SerialExecutor serial;
  const SparseScene scene(2.5, 64, 64, 0.1, 3);
  SurfaceRequest request = request_for(scene, 16);
  double square = 0.0, count = 0.0;
  request.on_draw = [&](int, const Grid<float>& draw_m) {
    for (std::size_t i = 0; i < draw_m.size(); ++i)
      if (!std::isnan(scene.height[i])) {
        square += std::pow((static_cast<double>(draw_m[i]) - static_cast<double>(scene.height[i])) / scene.sigma, 2);
        count += 1.0;
      }
  };
  ASSERT_TRUE(reconstruct_szeliski(cells_of(scene), request, {}, serial));
  // prior variance of a cell given the others ≫ noise: misfit/noise is χ with nearly all of its degrees of freedom;
  // 16 · 400 of them: 5 standard deviations are .09, 5 % are the prior's
  EXPECT_NEAR(std::sqrt(square / count), 0.975, 0.07);
}

TEST(Szeliski, TheMeanIsThatOfTheDrawsAndTheirSpreadIsReported) {
  SerialExecutor serial;
  const SparseScene scene(2.5, 20, 13, 0.1, 5);
  constexpr int kDraws = 400;
  SurfaceRequest request = request_for(scene, kDraws);
  Grid<double> sum(20, 13, 0.0);
  request.on_draw = [&](int, const Grid<float>& draw_m) {
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += static_cast<double>(draw_m[i]) / kDraws;
  };
  const auto estimate = reconstruct_szeliski(cells_of(scene), request, {.sweeps = 3}, serial);
  ASSERT_TRUE(estimate);
  for (std::size_t i = 0; i < sum.size(); ++i)  // 260 cells, 4.5 standard errors: false alarm 2e-3
    EXPECT_NEAR(sum[i], estimate->mean_m[i], 4.5 / std::sqrt(kDraws) * static_cast<double>(estimate->sd_m[i]));
}

TEST(Szeliski, ResultsDependOnSeedAloneAndFollowHeights) {
  SerialExecutor serial;
  BackwardExecutor backward;
  const SparseScene scene(2.4, 37, 50, 0.1, 6);
  SurfaceRequest request = request_for(scene, 6);
  std::vector<Grid<float>> first, second, moved;
  const SzeliskiOptions options{.sweeps = 4};
  keep_draws(request, first);
  const auto a = reconstruct_szeliski(cells_of(scene), request, options, serial);
  keep_draws(request, second);
  const auto b = reconstruct_szeliski(cells_of(scene), request, options, backward);
  ASSERT_TRUE(a && b);
  EXPECT_EQ(a->mean_m, b->mean_m);
  EXPECT_EQ(a->sd_m, b->sd_m);
  EXPECT_EQ(first, second);
  ASSERT_EQ(first.size(), 6U);
  EXPECT_NE(first[0], first[1]);

  CellSamples raised = cells_of(scene);  // twice as high and 8 m up
  for (std::size_t i = 0; i < raised.height_m.size(); ++i) {
    raised.height_m[i] = 8.0F + 2.0F * raised.height_m[i];
    raised.variance_m2[i] *= 4.0F;
  }
  request.law.law.amplitude_m *= 2.0;
  keep_draws(request, moved);
  ASSERT_TRUE(reconstruct_szeliski(raised, request, options, serial));
  for (std::size_t i = 0; i < moved[0].size(); ++i) EXPECT_NEAR(moved[0][i], 8.0F + 2.0F * first[0][i], 1e-4F);
}

TEST(Szeliski, WithoutTemperatureEveryDrawIsTheMeanAndThereIsNoSpread) {
  SerialExecutor serial;
  const SparseScene scene(2.5, 16, 16, 0.1, 7);
  SurfaceRequest request = request_for(scene, 2);
  std::vector<Grid<float>> draws;
  keep_draws(request, draws);
  const auto estimate = reconstruct_szeliski(cells_of(scene), request, {.temperature = kZero}, serial);
  ASSERT_TRUE(estimate);
  ASSERT_EQ(draws.size(), 2U);
  EXPECT_EQ(draws[0], estimate->mean_m);
  EXPECT_TRUE(std::isnan(estimate->sd_m[0]));
}

TEST(Szeliski, OneCellMakesALevelSurface) {
  SerialExecutor serial;
  for (const auto& [rows, columns] : {std::pair{1, 1}, {1, 9}, {12, 1}, {9, 16}}) {
    CellSamples samples = no_cells(rows, columns);
    measure(samples, rows / 2, columns / 2, 3.25, 1e-4);
    const auto estimate = reconstruct_szeliski(samples, request_for({2.5, 0.2}, rows, columns), {}, serial);
    ASSERT_TRUE(estimate) << rows << " x " << columns;
    for (const float value : estimate->mean_m) EXPECT_NEAR(value, 3.25F, 1e-4F);
    for (const float value : estimate->sd_m) EXPECT_TRUE(value > 0.0F);
  }
}

TEST(Szeliski, ContradictionsAreWeighedByTheirNoise) {
  SerialExecutor serial;
  CellSamples samples = no_cells(1, 2);  // two neighbours that differ by a thousand times what the law makes likely
  measure(samples, 0, 0, 0.0, 100.0);
  measure(samples, 0, 1, 50.0, 300.0);
  const auto estimate = reconstruct_szeliski(samples, request_for({2.5, 0.01}, 1, 2), {}, serial);
  ASSERT_TRUE(estimate);
  EXPECT_NEAR(estimate->mean_m[0], 12.5F, 0.01F);  // their weighted mean
  EXPECT_NEAR(estimate->mean_m[1], 12.5F, 0.01F);
}

TEST(Szeliski, BadInputIsNamed) {
  SerialExecutor serial;
  const FractalLaw law{2.5, 0.2};
  const auto error = [&](const CellSamples& samples, const SurfaceRequest& request, int sweeps = 5) {
    const auto result = reconstruct_szeliski(samples, request, {.sweeps = sweeps}, serial);
    return result ? Error{ErrorKind::internal, "no error"} : result.error();
  };
  CellSamples one = no_cells(4, 4);
  measure(one, 1, 1, 0.5, 0.01);
  EXPECT_EQ(error(no_cells(4, 4), request_for(law, 4, 4)).message,
            "szeliski: expected at least 1 measured cell in 4 x 4, found 0");
  EXPECT_EQ(error(one, request_for(law, 4, 5)).message, "szeliski: expected samples on 4 x 5 cells, found 4 x 4");
  EXPECT_EQ(error(one, request_for({3.0, 0.2}, 4, 4)).message, "szeliski: expected 2 < D < 3, found D = 3");
  EXPECT_EQ(error(one, request_for({2.5, 0.0}, 4, 4)).message, "szeliski: expected a finite amplitude > 0 m, found 0");
  EXPECT_EQ(error(one, request_for(law, 4, 4, -1)).message, "szeliski: expected at least 0 draws, found -1");
  EXPECT_EQ(error(one, request_for(law, 4, 4), 0).kind, ErrorKind::usage);
  SurfaceRequest varying = request_for(law, 4, 4);
  varying.law.dimension.assign(4, 4, 2.5F);
  varying.law.amplitude_m.assign(4, 4, 0.2F);
  EXPECT_EQ(error(one, varying).kind, ErrorKind::usage);
  measure(one, 2, 2, 1.0, 0.0);
  EXPECT_EQ(error(one, request_for(law, 4, 4)).message,
            "szeliski: expected a finite height and a variance > 0 in cell (2, 2), found 1 m and 0 m2");
}

}  // namespace
}  // namespace scree::fractal
