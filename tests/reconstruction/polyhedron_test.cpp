#include "fractal/reconstruction/polyhedron.hpp"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <vector>

#include "core/random.hpp"
#include "tests/reconstruction/triangle_scene.hpp"

namespace scree::fractal {
namespace {

TEST(Polyhedron, PassesThroughTheSamplesInEveryRealisation) {
  const ScatteredScene scene(2.4, 60, 0.1, 1);
  for (const Grid<float>& draw : draws_of(scene.request, [&](const SurfaceRequest& request) {
         SerialExecutor serial;
         return reconstruct_polyhedron(scene.samples, request, serial);
       })) {
    for (std::size_t i = 0; i < scene.samples.size(); ++i)
      EXPECT_NEAR(draw(scene.row(i), scene.column(i)), scene.samples.z_m[i], 1e-6);
  }
}

// The corners are sampled, so the hull holds every centre.
TEST(Polyhedron, CoversTheHullAndNothingElse) {
  ScatteredScene scene(2.5, 40, 0.05, 2);
  SerialExecutor serial;
  const auto part = reconstruct_polyhedron(scene.samples, scene.request, serial);
  ASSERT_TRUE(part) << part.error().message;
  EXPECT_TRUE(std::isnan(part->mean_m(0, 0)) || std::isnan(part->mean_m(39, 39)) || std::isnan(part->mean_m(0, 39)));
  scene.add_corners();
  const auto whole = reconstruct_polyhedron(scene.samples, scene.request, serial);
  for (const float z : whole->mean_m) EXPECT_TRUE(std::isfinite(z));
  for (const float sd : whole->sd_m) EXPECT_TRUE(std::isfinite(sd));
}

// Along the hypotenuse of one triangle of whole cells: the first iteration raises the midpoint by the formula's sd,
// with ‖Δ‖ half the edge. 1000 realisations: the variance within 4·√(2/1000) = 18 %, false alarm 6e-5.
TEST(Polyhedron, RaisesAMidpointByTheConditionalSdOfFractionalBrownianMotion) {
  SurfaceRequest request{{9, 9, 0.5}, {{2.3, 0.7}, {}, {}}, 1000, 1, {}, {}};
  const HeightSamples samples{{0.25, 4.25, 0.25}, {0.25, 0.25, 4.25}, {0.0, 2.0, 4.0}, {0, 0, 0}};
  SerialExecutor serial;
  const auto estimate = reconstruct_polyhedron(samples, request, {.iterations = 1, .shortest_edge_m = 0.0}, serial);
  ASSERT_TRUE(estimate) << estimate.error().message;
  const double half_m = 2.0 * std::sqrt(2.0), hurst = 0.7;
  const double sd = std::sqrt(1.0 - std::pow(2.0, 2.0 * hurst - 2.0)) * 0.7 * std::pow(half_m, hurst);
  EXPECT_NEAR(std::pow(estimate->sd_m(4, 4) / sd, 2), 1.0, 0.18);
  EXPECT_NEAR(estimate->mean_m(4, 4), 3.0, 4.0 * sd / std::sqrt(1000.0));
  EXPECT_EQ(estimate->iterations, 1);
  EXPECT_EQ(estimate->sd_m(0, 0), 0.0F);
  // by hand from fBm itself: var of the middle given ends 2Δ apart = Δ^2H − (2Δ)^2H/4
  EXPECT_NEAR(sd * sd, 0.49 * (std::pow(half_m, 1.4) - std::pow(2 * half_m, 1.4) / 4), 1e-12);
}

// A plane stays a plane when nothing is rough: the triangles meet, whatever edges were broken.
TEST(Polyhedron, SplitsWithoutCracks) {
  ScatteredScene scene(2.5, 50, 0.1, 3);
  scene.add_corners();
  scene.request.law.law.amplitude_m = 1e-9;
  for (std::size_t i = 0; i < scene.samples.size(); ++i)
    scene.samples.z_m[i] = 0.3 * scene.samples.x_m[i] - 0.7 * scene.samples.y_m[i];
  SerialExecutor serial;
  for (const double edge_m : {0.0, 0.17, 0.5}) {
    const auto estimate =
        reconstruct_polyhedron(scene.samples, scene.request, {.iterations = 0, .shortest_edge_m = edge_m}, serial);
    for (int r = 0; r < 50; ++r)
      for (int c = 0; c < 50; ++c)
        ASSERT_NEAR(estimate->mean_m(r, c), 0.3 * (c + 0.5) * 0.1 - 0.7 * (r + 0.5) * 0.1, 1e-6);
  }
}

TEST(Polyhedron, IsTheSameEveryTimeAndWithAnyThreads) {
  const ScatteredScene scene(2.5, 40, 0.1, 4);
  SerialExecutor serial;
  Backwards backwards;
  const auto a = reconstruct_polyhedron(scene.samples, scene.request, serial);
  const auto b = reconstruct_polyhedron(scene.samples, scene.request, backwards);
  EXPECT_TRUE(same(a->mean_m, b->mean_m));
  EXPECT_TRUE(same(a->sd_m, b->sd_m));
  SurfaceRequest other = scene.request;
  other.seed = 9;
  EXPECT_FALSE(same(a->mean_m, reconstruct_polyhedron(scene.samples, other, serial)->mean_m));
}

TEST(Polyhedron, SaysWhatIsWrong) {
  const ScatteredScene scene(2.5, 20, 0.1, 5);
  SerialExecutor serial;
  const auto message = [&](const HeightSamples& samples, const SurfaceRequest& request,
                           PolyhedronOptions options = {}) {
    const auto result = reconstruct_polyhedron(samples, request, options, serial);
    EXPECT_FALSE(result);
    return result.error().message;
  };
  EXPECT_EQ(message({}, scene.request), "triangulation: expected at least 3 points, found 0");
  EXPECT_EQ(message({{1, 1, 1}, {1, 1, 1}, {0, 1, 2}, {0, 0, 0}}, scene.request),
            "triangulation: expected points off one line, found 3 on one");
  EXPECT_EQ(message({{1, 2, 3}, {1, 1, 2}, {0, NAN, 2}, {0, 0, 0}}, scene.request),
            "samples: expected finite heights, found nan at sample 1");
  EXPECT_EQ(message({{1, 2, 3}, {1, 1, 2}, {0, 1, 2}, {0, 0}}, scene.request),
            "samples: expected as many x, y and variances as heights, found 3, 3 and 2 for 3");
  EXPECT_EQ(message(scene.samples, scene.request, {-1, 0.0}), "polyhedron: expected 0 or more iterations, found -1");
  SurfaceRequest steep = scene.request;
  steep.law.law.dimension = 3.0;
  EXPECT_EQ(message(scene.samples, steep), "surface law: expected 2 < D < 3, found D = 3");
  SurfaceRequest map = scene.request;
  map.law.dimension = map.law.amplitude_m = Grid<float>(20, 19, 2.5F);
  EXPECT_EQ(message(scene.samples, map), "surface law: expected a map of 20 x 20 cells, found 20 x 19");
  map.law.dimension = Grid<float>(20, 20, 2.5F);
  map.law.amplitude_m = Grid<float>(20, 20, 0.1F);
  map.law.dimension(3, 4) = NAN;
  EXPECT_EQ(
      message(scene.samples, map),
      "surface law: expected 2 < D < 3 and a finite amplitude_m > 0 in every cell, found nan and 0.1 in cell 3, 4");
}

// Left half rough, right half nearly flat: a law for each cell.
TEST(Polyhedron, TakesALawForEveryCell) {
  ScatteredScene scene(2.5, 40, 0.1, 6);
  scene.add_corners();
  std::fill(scene.samples.z_m.begin(), scene.samples.z_m.end(), 0.0);
  scene.request.law.dimension = Grid<float>(40, 40, 2.4F);
  scene.request.law.amplitude_m = Grid<float>(40, 40, 1e-7F);
  for (int r = 0; r < 40; ++r)
    for (int c = 0; c < 20; ++c) scene.request.law.amplitude_m(r, c) = 0.5F;
  SerialExecutor serial;
  const auto estimate = reconstruct_polyhedron(scene.samples, scene.request, serial);
  ASSERT_TRUE(estimate) << estimate.error().message;
  float left = 0.0F, right = 0.0F;
  for (int r = 0; r < 40; ++r) {
    for (int c = 0; c < 16; ++c) left = std::max(left, estimate->sd_m(r, c));
    for (int c = 30; c < 40; ++c) right = std::max(right, estimate->sd_m(r, c));
  }
  EXPECT_GT(left, 0.05F);
  EXPECT_LT(right, 0.01F);
}

TEST(Polyhedron, RepeatedPlacesCarryTheirMean) {
  const SurfaceRequest request{{5, 5, 1.0}, {{2.5, 0.1}, {}, {}}, 1, 1, {}, {}};
  const HeightSamples samples{{0.5, 4.5, 0.5, 0.5}, {0.5, 0.5, 4.5, 0.5}, {1.0, 0.0, 0.0, 4.0}, {0.1, 0.1, 0.1, 0.2}};
  SerialExecutor serial;
  const auto estimate = reconstruct_polyhedron(samples, request, serial);
  EXPECT_NEAR(estimate->mean_m(0, 0), 2.0, 1e-6);  // (1/0.1 + 4/0.2) / (1/0.1 + 1/0.2)
}

}  // namespace
}  // namespace scree::fractal
