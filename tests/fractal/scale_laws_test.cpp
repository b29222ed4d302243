#include "fractal/scale_laws.hpp"

#include "composite_surfaces.hpp"
#include <array>
#include <cmath>
#include <gtest/gtest.h>
#include <string>
#include <vector>

namespace scree::fractal {
namespace {

ScaleAnalysis analyse(const SurveyPoints& survey) {
  SerialExecutor serial;
  auto result = analyse_scales(survey, {}, serial);
  EXPECT_TRUE(result) << result.error().message;
  return result ? *result : ScaleAnalysis{};
}

/// How often each law is chosen for `surfaces` rasters of 256².
std::array<int, 4> chosen(const Composite& composite, int surfaces, double& worst_h) {
  std::array<int, 4> counts{};
  worst_h = 0.0;
  for (int k = 0; k < surfaces; ++k) {
    const Raster raster = composite_raster(composite, 256, static_cast<std::uint64_t>(900 + k));
    const auto found = analyse(raster.survey());
    ++counts[found.chosen];
    if (found.best().law == composite.truth)
      worst_h = std::max(worst_h, std::abs(3.0 - found.best().dimension - composite.hurst));
  }
  return counts;
}

// n = 8 surfaces a row. Right with probability .95 or more (docs/fractal.md): 5 or more of 8 (false alarm 4e-4 a row).
// H: 4.5 of the RMSEs of 100 surfaces that stand there, row by row (8 draws: 6e-5).
TEST(ScaleLaws, TheRightLawIsChosen) {
  struct Row {
    Composite composite;
    double sigma;
  };
  const std::vector<Row> rows{{{ScaleLaw::power, 0.2}, .0032},
                              {{ScaleLaw::power, 0.5}, .0047},
                              {{ScaleLaw::power, 0.8}, .0059},
                              {{ScaleLaw::two_scales, 0.2, 0.8, 10.0}, .013},
                              {{ScaleLaw::two_scales, 0.35, 0.8, 10.0}, .027},
                              {{ScaleLaw::power_and_noise, 0.65}, .016}};
  for (const Row& row : rows) {
    double worst = 0.0;
    const auto counts = chosen(row.composite, 8, worst);
    EXPECT_GE(counts[static_cast<std::size_t>(row.composite.truth)], 5)
        << scale_law_name(row.composite.truth) << " " << row.composite.hurst;
    EXPECT_LT(worst, 4.5 * row.sigma) << scale_law_name(row.composite.truth) << " " << row.composite.hurst;
  }
}

// High-passed fBm is no plateau law exactly: H is .026 too small with an error of .003 at most (docs/fractal.md).
// Limit: .026 and 4.5 of that (4 draws: 3e-5).
TEST(ScaleLaws, GroundThatStopsGrowingIsAPlateau) {
  double worst = 0.0;
  const auto counts = chosen({ScaleLaw::plateau, 0.65}, 4, worst);
  EXPECT_EQ(counts[3], 4);
  EXPECT_LT(worst, 0.0395);
}

TEST(ScaleLaws, PlanesAndUnitsChangeNothing) {
  const Raster raster = composite_raster({ScaleLaw::two_scales, 0.2, 0.8, 8.0}, 96, 5);
  const auto expected = analyse(raster.survey());
  Raster moved = raster;
  for (std::size_t i = 0; i < moved.z.size(); ++i) {
    moved.z[i] = 3.0 * moved.z[i] + 2.0 * moved.x[i] - moved.y[i];
    moved.x[i] = 4.0 * moved.x[i] + 524288.0, moved.y[i] = 4.0 * moved.y[i] + 4194304.0;
  }
  const auto found = analyse(moved.survey());
  ASSERT_EQ(found.chosen, expected.chosen);
  EXPECT_NEAR(found.best().dimension, expected.best().dimension, 1e-3);
  EXPECT_NEAR(found.best().lag_max_m / expected.best().lag_max_m, 4.0, 0.02);
}

TEST(ScaleLaws, PointsAndModelAreInMetres) {
  const Raster raster = composite_raster({ScaleLaw::power, 0.5}, 128, 6);
  const auto found = analyse(raster.survey());
  ASSERT_EQ(found.points.size(), found.log_model.size());
  ASSERT_GE(found.points.size(), 12U);
  ASSERT_EQ(found.fits.size(), 4U);
  ASSERT_EQ(found.best().law, ScaleLaw::power);
  for (std::size_t i = 0; i < found.points.size(); ++i) {
    const double law = std::log(found.best().amplitude_m) + (3.0 - found.best().dimension) * found.points[i].log_lag;
    EXPECT_NEAR(found.log_model[i], law, 0.02);
    EXPECT_NEAR(found.points[i].log_change, found.log_model[i], 0.7);
  }
  EXPECT_NEAR(found.best().amplitude_m, 1.0, 0.1);
  EXPECT_LE(found.best().lag_min_m, found.best().lag_max_m);
}

TEST(ScaleLaws, RefusesWhatHasNoDimension) {
  SerialExecutor serial;
  Raster flat = composite_raster({ScaleLaw::power, 0.5}, 32, 7);
  for (double& z : flat.z) z = 1.5;
  const auto found = analyse_scales(flat.survey(), {}, serial);
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().kind, ErrorKind::bad_data);
}

}  // namespace
}  // namespace scree::fractal
