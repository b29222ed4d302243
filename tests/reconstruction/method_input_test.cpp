// What every method on cells makes of samples that say little, or nothing, or two things at once.

#include <gtest/gtest.h>
#include <string>
#include <vector>

#include "fractal/reconstruction/kriging.hpp"
#include "fractal/reconstruction/spline.hpp"
#include "fractal/reconstruction/szeliski.hpp"
#include "fractal/reconstruction/yokoya.hpp"
#include "tests/reconstruction/method_scene.hpp"

namespace scree::fractal {
namespace {

struct NamedMethod {
  std::string name;
  std::function<Result<SurfaceEstimate>(const CellSamples&, const SurfaceRequest&, Executor&)> run;
};

std::vector<NamedMethod> methods() {
  return {{"szeliski", [](const auto& s, const auto& r, auto& e) { return reconstruct_szeliski(s, r, {}, e); }},
          {"membrane", reconstruct_membrane},
          {"thin-plate", reconstruct_thin_plate},
          {"kriging", [](const auto& s, const auto& r, auto& e) { return reconstruct_kriging(s, r, {}, e); }}};
}

constexpr FractalLaw kLaw{2.4, 0.5};
constexpr SurfaceGrid kGrid{24, 31, kSceneCellM};

SurfaceRequest small_request(int draws = 1) {
  return request_for(kLaw, kGrid.rows, kGrid.columns, draws);
}

void add(HeightSamples& samples, double x_m, double y_m, double z_m, double variance_m2) {
  samples.x_m.push_back(x_m), samples.y_m.push_back(y_m), samples.z_m.push_back(z_m);
  samples.variance_m2.push_back(variance_m2);
}

TEST(MethodInput, NothingWithinTheGridIsAnErrorOfTheData) {
  SerialExecutor serial;
  HeightSamples outside;
  add(outside, -1.0, 0.5, 3.0, 0.01);
  add(outside, 1.0, 99.0, 3.0, 0.01);
  const CellSamples cells = bin_samples(outside, kGrid, small_request().law);
  EXPECT_EQ(cells.outside, 2U);
  for (const NamedMethod& method : methods()) {
    const auto result = method.run(cells, small_request(), serial);
    ASSERT_FALSE(result) << method.name;
    EXPECT_EQ(result.error().kind, ErrorKind::bad_data);
    EXPECT_EQ(result.error().message, method.name + ": expected at least 1 measured cell in 24 x 31, found 0");
  }
}

TEST(MethodInput, AllSamplesInOneCellMakeALevelMean) {
  SerialExecutor serial;
  HeightSamples samples;
  for (int i = 0; i < 9; ++i) add(samples, 1.01 + 0.01 * i, 1.05, 7.0, 0.01);
  const CellSamples cells = bin_samples(samples, kGrid, small_request().law);
  ASSERT_EQ(cells.cells, 1U);
  for (const NamedMethod& method : methods()) {
    const auto result = method.run(cells, small_request(), serial);
    ASSERT_TRUE(result) << method.name << ": " << result.error().message;
    for (const float value : result->mean_m) ASSERT_NEAR(value, 7.0F, 1e-3F) << method.name;
  }
}

// Same place, heights ten thousand noises apart: their weighted mean, and a finite surface around it.
TEST(MethodInput, ContradictionsInOneCellAreAveragedByTheirNoise) {
  SerialExecutor serial;
  HeightSamples samples;
  add(samples, 1.05, 1.05, 0.0, 1e-4);
  add(samples, 1.05, 1.05, 100.0, 3e-4);
  add(samples, 2.05, 1.05, 25.0, 1e-4);
  const CellSamples cells = bin_samples(samples, kGrid, small_request().law);
  for (const NamedMethod& method : methods()) {
    const auto result = method.run(cells, small_request(), serial);
    ASSERT_TRUE(result) << method.name;
    for (const float value : result->mean_m) ASSERT_NEAR(value, 25.0F, 1e-2F) << method.name;
  }
}

// Neighbouring cells that the law holds for impossible: the exact and the iterated methods stay finite and go through
// both.
TEST(MethodInput, ContradictionsOfNeighboursStayFinite) {
  SerialExecutor serial;
  CellSamples cells = no_cells(kGrid.rows, kGrid.columns);
  measure(cells, 10, 10, -500.0, 1e-4);
  measure(cells, 10, 11, 500.0, 1e-4);
  for (const NamedMethod& method : methods()) {
    const auto result = method.run(cells, small_request(), serial);
    ASSERT_TRUE(result) << method.name;
    for (const float value : result->mean_m) ASSERT_TRUE(std::isfinite(value)) << method.name;
    EXPECT_NEAR(result->mean_m(10, 10), -500.0F, 50.0F) << method.name;
    EXPECT_NEAR(result->mean_m(10, 11), 500.0F, 50.0F) << method.name;
  }
}

TEST(MethodInput, NoDrawsAreAskedForNoneAreHandedOutAndProgressEndsAtOne) {
  SerialExecutor serial;
  const SparseScene scene(2.5, 24, 31, 0.1, 1);
  for (const NamedMethod& method : methods())
    for (const int draws : {0, 3}) {
      SurfaceRequest request = request_for(scene, draws);
      std::vector<int> handed;
      double progress = -1.0;
      request.on_draw = [&](int k, const Grid<float>&) { handed.push_back(k); };
      request.on_progress = [&](double share) {
        EXPECT_GE(share, progress);
        progress = share;
      };
      ASSERT_TRUE(method.run(cells_of(scene), request, serial)) << method.name;
      EXPECT_EQ(handed.size(), static_cast<std::size_t>(draws)) << method.name;
      for (std::size_t k = 0; k < handed.size(); ++k) EXPECT_EQ(handed[k], static_cast<int>(k));
      EXPECT_NEAR(progress, 1.0, 1e-12) << method.name;
    }
}

TEST(MethodInput, ATemperatureThatFloatsCannotHoldIsRefused) {
  SerialExecutor serial;
  CellSamples cells = no_cells(4, 4);
  measure(cells, 1, 1, 0.0, 1e-4);
  for (const double value_m2 : {1e-12, 1e9}) {
    const auto result =
        reconstruct_szeliski(cells, request_for(kLaw, 4, 4), {{Temperature::Kind::fixed, value_m2}, 5, false}, serial);
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().kind, ErrorKind::usage);
    EXPECT_TRUE(result.error().message.starts_with("szeliski: expected a temperature of 0 or from 1e-06 to 1e+06"));
  }
}

}  // namespace
}  // namespace scree::fractal
