#include "mapping/local_elevation.hpp"

#include <cmath>
#include <gtest/gtest.h>

#include "core/random.hpp"
#include "fractal/surface.hpp"

namespace scree::mapping {
namespace {

constexpr int kSide = 96;
constexpr double kCell_m = 0.1;
const fractal::FractalLaw kLaw{2.4, 0.1};

/// A rough window of which a random share is measured with a known noise.
struct Scene {
  Grid<float> truth = *fractal::fbm_surface(kLaw, kSide, kSide, kCell_m, 5);
  GroundLayers ground;
  Grid<std::uint8_t> everywhere = Grid<std::uint8_t>(kSide, kSide, 1);
  LatticeWindow window{{-7, 11}, kSide, kSide};

  Scene() {
    for (Grid<float>* grid : {&ground.height_m, &ground.ceiling_m}) grid->assign(kSide, kSide, NAN);
    for (Grid<float>* grid : {&ground.variance_m2, &ground.noise_variance_m2, &ground.relief_m2})
      grid->assign(kSide, kSide, 0.0F);
    ground.measured.assign(kSide, kSide, 0);
  }
  static fractal::LawMap law(const fractal::FractalLaw& one) {
    return {one, Grid<float>(kSide, kSide, static_cast<float>(one.dimension)),
            Grid<float>(kSide, kSide, static_cast<float>(one.amplitude_m))};
  }
  void measure(int row, int column) {
    constexpr double kSigma_m = 0.003;
    ground.measured(row, column) = 1;
    ground.variance_m2(row, column) = static_cast<float>(kSigma_m * kSigma_m);
    ground.height_m(row, column) =
        truth(row, column) + static_cast<float>(kSigma_m * random_normals(1, 2, column, row)[0]);
  }
  void measure_share(double share, std::uint64_t stream) {
    for (int r = 0; r < kSide; ++r)
      for (int c = 0; c < kSide; ++c)
        if (to_uniform(random_words(3, stream, c, r)[0]) < share) measure(r, c);
  }
};

struct Coverage {
  double share = 0.0, error2 = 0.0;
};
Coverage coverage(const Scene& scene, const fractal::Reconstruction& out) {
  double covered = 0.0, n = 0.0, square = 0.0;
  for (std::size_t i = 0; i < scene.truth.size(); ++i) {
    if (scene.ground.measured[i] != 0) continue;
    const double z = static_cast<double>((out.mean_m[i] - scene.truth[i]) / out.sd_m[i]);
    covered += std::abs(z) < 1.6449 ? 1.0 : 0.0;
    square += z * z;
    n += 1.0;
  }
  return {covered / n, square / n};
}

TEST(LocalElevation, HasNothingToSayBeforeTheFirstMeasurement) {
  const Scene scene;
  SerialExecutor serial;
  LocalElevation elevation({kCell_m, kSide, 8, 1});
  EXPECT_EQ(elevation.update(scene.ground, scene.window, scene.law(kLaw), scene.everywhere, serial), nullptr);
}

// One surface: the share of covered cells has a standard error of about .01 (8,800 cells, some 900 independent gaps).
TEST(LocalElevation, IntervalsCoverWhatTheySayUnderTheTrueLaw) {
  Scene scene;
  scene.measure_share(0.08, 1);
  SerialExecutor serial;
  LocalElevation elevation({kCell_m, kSide, 8, 1});
  const auto* out = elevation.update(scene.ground, scene.window, scene.law(kLaw), scene.everywhere, serial);
  ASSERT_NE(out, nullptr);
  EXPECT_EQ(out->draws_m.size(), 8U);
  EXPECT_NEAR(coverage(scene, *out).share, 0.9, 0.04);
}

// An amplitude that is told too small by half makes errors twice what they are said to be; the innovations of what
// comes in frame by frame (3 % of the cells each) set it right.
TEST(LocalElevation, InnovationsMendAnAmplitudeThatIsWrong) {
  Scene scene;
  scene.measure_share(0.06, 1);
  SerialExecutor serial;
  LocalElevation elevation({kCell_m, kSide, 8, 1});
  const fractal::FractalLaw wrong{kLaw.dimension, 0.5 * kLaw.amplitude_m};
  const auto* out = elevation.update(scene.ground, scene.window, scene.law(wrong), scene.everywhere, serial);
  const double before = coverage(scene, *out).error2;
  for (std::uint64_t frame = 2; frame < 8; ++frame) {
    scene.measure_share(0.03, frame);
    out = elevation.update(scene.ground, scene.window, scene.law(wrong), scene.everywhere, serial);
  }
  EXPECT_GT(before, 2.5);
  EXPECT_LT(coverage(scene, *out).error2, 1.35);
  EXPECT_GT(coverage(scene, *out).error2, 0.7);
}

TEST(LocalElevation, DrawsStayBelowTheRaysAfterAFewFrames) {
  Scene scene;
  for (int r = 0; r < kSide; ++r)
    for (int c = 0; c < kSide; ++c)
      if (c < 36 || c >= 60) scene.measure(r, c);
  float sum_m = 0.0F;
  for (int r = 0; r < kSide; ++r) sum_m += 0.5F * (scene.truth(r, 35) + scene.truth(r, 60));
  const float ceiling_m = sum_m / kSide - 0.3F;
  for (int r = 20; r < 76; ++r)
    for (int c = 42; c < 54; ++c) scene.ground.ceiling_m(r, c) = ceiling_m;
  SerialExecutor serial;
  LocalElevation elevation({kCell_m, kSide, 8, 1});
  const fractal::Reconstruction* out = nullptr;
  for (int frame = 0; frame < 4; ++frame)
    out = elevation.update(scene.ground, scene.window, scene.law(kLaw), scene.everywhere, serial);
  int above = 0, cells = 0;
  for (const Grid<float>& draw : out->draws_m)
    for (int r = 22; r < 74; ++r)
      for (int c = 43; c < 53; ++c, ++cells) above += draw(r, c) > ceiling_m + 0.02F ? 1 : 0;
  // a push is soft: a tenth of the cells may still stick out by more than 2 cm
  EXPECT_LT(above, cells / 10);
  for (int r = 0; r < kSide; ++r) ASSERT_NEAR(out->mean_m(r, 20), scene.truth(r, 20), 0.02F);
}

TEST(LocalElevation, DrawsAreCoherentFromFrameToFrame) {
  Scene scene;
  scene.measure_share(0.1, 1);
  SerialExecutor serial;
  LocalElevation elevation({kCell_m, kSide, 8, 1});
  const auto* out = elevation.update(scene.ground, scene.window, scene.law(kLaw), scene.everywhere, serial);
  const Grid<float> before = out->draws_m[3];
  out = elevation.update(scene.ground, scene.window, scene.law(kLaw), scene.everywhere, serial);
  double change2 = 0.0, spread2 = 0.0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    change2 += std::pow(static_cast<double>(out->draws_m[3][i] - before[i]), 2);
    spread2 += std::pow(static_cast<double>(out->sd_m[i]), 2);
  }
  EXPECT_LT(change2, 0.03 * spread2);  // the solver's tolerance
}

}  // namespace
}  // namespace scree::mapping
