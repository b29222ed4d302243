#include "fractal/reconstruction/barycentre.hpp"

#include <Eigen/Dense>
#include <cmath>
#include <gtest/gtest.h>
#include <vector>

#include "fractal/reconstruction/barycentre_refinement.hpp"
#include "fractal/reconstruction/local_kriging.hpp"
#include "fractal/reconstruction/triangle_kriging.hpp"
#include "tests/reconstruction/surface_metrics.hpp"
#include "tests/reconstruction/triangle_scene.hpp"

namespace scree::fractal {
namespace {

/// Variance of z(p) − Σ w z(known) for weights that sum to 1, straight from the variogram.
double variance_of(const std::vector<PlanePoint>& known, const PlanePoint& p, const double* w, double hurst,
                   double unit) {
  const auto v = [&](const PlanePoint& a, const PlanePoint& b) {
    return unit * unit * std::pow(std::hypot(a.x - b.x, a.y - b.y), 2.0 * hurst);
  };
  double sum = 0.0;
  for (std::size_t i = 0; i < known.size(); ++i) {
    sum += w[i] * v(p, known[i]);
    for (std::size_t j = 0; j < known.size(); ++j) sum -= 0.5 * w[i] * w[j] * v(known[i], known[j]);
  }
  return sum;
}

/// Intrinsic kriging as the textbook writes it, with a Lagrange multiplier.
std::vector<double> kriging(const std::vector<PlanePoint>& known, const PlanePoint& p, double hurst) {
  const auto n = static_cast<Eigen::Index>(known.size());
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(n + 1, n + 1);
  Eigen::VectorXd b = Eigen::VectorXd::Ones(n + 1);
  const auto v = [&](const PlanePoint& q, const PlanePoint& r) {
    return std::pow(std::hypot(q.x - r.x, q.y - r.y), 2.0 * hurst);
  };
  for (Eigen::Index i = 0; i < n; ++i) {
    b(i) = v(p, known[static_cast<std::size_t>(i)]);
    a(i, n) = a(n, i) = 1.0;
    for (Eigen::Index j = 0; j < n; ++j)
      a(i, j) = v(known[static_cast<std::size_t>(i)], known[static_cast<std::size_t>(j)]);
  }
  const Eigen::VectorXd w = a.fullPivLu().solve(b);
  return {w.data(), w.data() + n};
}

TEST(LocalLaw, IsKriging) {
  const std::vector<PlanePoint> all = {{0, 0}, {5, 1}, {1, 4}, {-2, 3}, {4, 5}, {-1, -6}, {8, 8}};
  const PlanePoint p{1.5, 1.25};
  for (const double hurst : {0.1, 0.5, 0.9})
    for (std::size_t count = 1; count <= all.size(); ++count) {
      const std::vector<PlanePoint> known(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(count));
      const std::vector<double> expected = kriging(known, p, hurst);
      const LocalLaw law = local_law(known, p, hurst, 0.3);
      for (std::size_t i = 0; i < count; ++i) EXPECT_NEAR(law.weight[i], expected[i], 1e-10);
      EXPECT_NEAR(law.variance, variance_of(known, p, expected.data(), hurst, 0.3), 1e-12);
    }
}

TEST(LocalLaw, APointTwiceSaysNothingNew) {
  const std::vector<PlanePoint> once = {{0, 0}, {5, 1}, {1, 4}}, twice = {{0, 0}, {5, 1}, {5, 1}, {1, 4}};
  const LocalLaw a = local_law(once, {2, 2}, 0.4, 1.0), b = local_law(twice, {2, 2}, 0.4, 1.0);
  EXPECT_NEAR(a.variance, b.variance, 1e-12);
  EXPECT_NEAR(a.weight[1], b.weight[1] + b.weight[2], 1e-12);
}

// The three laws of a triangle against the variogram itself; and where the published one goes wrong: its three
// variances, each exact, have the exact variance as their mean, not as their sum over nine.
TEST(TriangleLaw, ExactLawsFollowFromTheVariogram) {
  const std::array<PlanePoint, 3> corners = {{{0, 0}, {5, 1}, {1, 4}}};
  const std::vector<PlanePoint> known(corners.begin(), corners.end());
  const PlanePoint p{2.0, 5.0 / 3.0};
  for (const double hurst : {0.2, 0.5, 0.8}) {
    const TriangleVariogram v(corners, p, hurst, 0.7);
    const TriangleLaw conditional = conditional_law(v), mean = exact_mean_law(v);
    const std::vector<double> weights = kriging(known, p, hurst);
    for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(conditional.weight[i], weights[i], 1e-12);
    EXPECT_NEAR(conditional.variance, variance_of(known, p, weights.data(), hurst, 0.7), 1e-12);
    EXPECT_NEAR(mean.variance, variance_of(known, p, mean.weight.data(), hurst, 0.7), 1e-12);
    EXPECT_LT(conditional.variance, mean.variance);
    double displaced = 0.0;
    for (std::size_t k = 0; k < 3; ++k)
      displaced += v.to_corner[k] - variance_of(known, corners[k], mean.weight.data(), hurst, 0.7);
    EXPECT_NEAR(displaced / 3.0, mean.variance, 1e-12);
  }
}

TEST(TriangleLaw, AnEquilateralTriangleHasEqualWeights) {
  const TriangleVariogram v({{{0, 0}, {2, 0}, {1, std::sqrt(3.0)}}}, {1, 1 / std::sqrt(3.0)}, 0.3, 1.0);
  const TriangleLaw law = conditional_law(v);
  for (const double w : law.weight) EXPECT_NEAR(w, 1.0 / 3.0, 1e-12);
  EXPECT_NEAR(law.variance, exact_mean_law(v).variance, 1e-12);
}

// One triangle, one insertion: the variance by hand. Corners (0, 0), (4, 0), (0, 4) with heights 0, 3, 0 in one-metre
// cells, amplitude 1, H = ½: V to the barycentre (4/3, 4/3) = √2·4/3 = 1.886 and twice √(64/9 + 16/9) = 2.981; spread =
// ((1)² + (2)² + (1)²)/3 = 2: A² = 0 (clamped), .981, .981, variance .2181. 2000 realisations: 4·√(2/2000) = 12.6 %,
// false alarm 6e-5.
TEST(Barycentre, PublishedVarianceByHand) {
  SurfaceRequest request;
  request.grid = {7, 7, 1.0};
  request.law.law = {2.5, 1.0};
  request.draws = 2000;
  const HeightSamples samples{{0.5, 4.5, 0.5}, {0.5, 0.5, 4.5}, {0, 3, 0}, {0, 0, 0}};
  BarycentreRefinement refinement(*triangulate(samples, request), request, {}, 2000);
  ASSERT_EQ(refinement.refine(1), 1);
  double square = 0.0;
  const Delaunay& mesh = refinement.mesh();
  EXPECT_NEAR(mesh.point(3).x, 4.0 / 3.0, 1e-12);
  EXPECT_NEAR(mesh.point(3).y, 4.0 / 3.0, 1e-12);
  for (int k = 0; k < 2000; ++k) square += std::pow(refinement.height(3, k) - 1.0, 2) / 2000;
  const double to = std::sqrt(80.0) / 3.0;
  EXPECT_NEAR(square / (2.0 * (to - 2.0) / 9.0), 1.0, 0.126);
}

TEST(Barycentre, PassesThroughTheSamplesInEveryRealisation) {
  const ScatteredScene scene(2.4, 60, 0.1, 1);
  for (const BarycentreOptions& options : {BarycentreOptions{}, corrected_barycentre()})
    for (const Grid<float>& draw : draws_of(scene.request, [&](const SurfaceRequest& request) {
           SerialExecutor serial;
           return reconstruct_barycentre(scene.samples, request, options, serial);
         }))
      for (std::size_t i = 0; i < scene.samples.size(); ++i)
        EXPECT_NEAR(draw(scene.row(i), scene.column(i)), scene.samples.z_m[i], 1e-6);
}

TEST(Barycentre, OnePointForEachCellWithinTheHullByDefault) {
  ScatteredScene scene(2.5, 50, 0.1, 2);
  scene.add_corners();
  SerialExecutor serial;
  const auto estimate = reconstruct_barycentre(scene.samples, scene.request, serial);
  ASSERT_TRUE(estimate) << estimate.error().message;
  EXPECT_EQ(estimate->iterations, 2500 - static_cast<int>(scene.samples.size()));
  EXPECT_TRUE(estimate->converged);
  for (const float z : estimate->mean_m) EXPECT_TRUE(std::isfinite(z));
}

TEST(Barycentre, WithoutInsertionsItIsLinearInterpolation) {
  ScatteredScene scene(2.5, 40, 0.1, 3);
  scene.add_corners();
  for (std::size_t i = 0; i < scene.samples.size(); ++i)
    scene.samples.z_m[i] = 2.0 * scene.samples.x_m[i] - scene.samples.y_m[i];
  BarycentreOptions options;
  options.insertions = 0;
  SerialExecutor serial;
  const auto estimate = reconstruct_barycentre(scene.samples, scene.request, options, serial);
  for (int r = 0; r < 40; ++r)
    for (int c = 0; c < 40; ++c) ASSERT_NEAR(estimate->mean_m(r, c), 0.2 * (c + 0.5) - 0.1 * (r + 0.5), 1e-6);
  for (const float sd : estimate->sd_m) EXPECT_EQ(sd, 0.0F);
}

// Locally Delaunay everywhere is Delaunay; barycentres of barycentres are no integers, the exact predicate decides.
TEST(Barycentre, TheRefinedTriangulationIsDelaunay) {
  const ScatteredScene scene(2.5, 40, 0.1, 4);
  const BarycentreOptions options = corrected_barycentre();
  BarycentreRefinement refinement(*triangulate(scene.samples, scene.request), scene.request, options, 1);
  EXPECT_EQ(refinement.refine(5000), 5000);
  refinement.insert_cell_centres();
  const Delaunay& mesh = refinement.mesh();
  EXPECT_GT(mesh.vertex_count(), 6000);
  EXPECT_EQ(mesh.triangle_count(), 2 * mesh.vertex_count() - 2);
  for (int t = 0; t < mesh.triangle_count(); ++t) {
    if (mesh.is_ghost(t)) continue;
    const auto& v = mesh.triangle(t).vertex;
    ASSERT_GT(orientation(mesh.point(v[0]), mesh.point(v[1]), mesh.point(v[2])), 0);
    for (const int other : mesh.triangle(t).neighbour)
      for (const int w : mesh.triangle(other).vertex)
        if (w != Delaunay::kInfinite) {
          ASSERT_LE(in_circle(mesh.point(v[0]), mesh.point(v[1]), mesh.point(v[2]), mesh.point(w)), 0);
        }
  }
}

// Two centres, the right one with ground that hardly moves: right of the bisector the surface is what linear
// interpolation of flat samples gives, left of it is not.
TEST(Barycentre, EachRegionOfInfluenceHasItsOwnLaw) {
  ScatteredScene scene(2.5, 40, 0.1, 5);
  scene.add_corners();
  std::fill(scene.samples.z_m.begin(), scene.samples.z_m.end(), 0.0);
  BarycentreOptions options = corrected_barycentre();
  options.centres = {{1.0, 2.0, {2.3, 0.5}}, {3.0, 2.0, {2.6, 1e-7}}};
  SerialExecutor serial;
  const auto estimate = reconstruct_barycentre(scene.samples, scene.request, options, serial);
  double left = 0.0, right = 0.0;
  for (int r = 0; r < 40; ++r)
    for (int c = 0; c < 40; ++c) {
      if (c < 17) left = std::max(left, static_cast<double>(estimate->sd_m(r, c)));
      if (c > 28) right = std::max(right, static_cast<double>(estimate->sd_m(r, c)));
    }
  EXPECT_GT(left, 0.05);
  EXPECT_LT(right, 0.01);
}

// As published, realisations are too smooth by .15 at D = 2.5 (docs/reconstruction.md, 20 surfaces, spread .005 between
// surfaces); corrected within .02. Two surfaces of 128² cells: spread about .01 each; bounds 4 s.e. away.
TEST(Barycentre, PublishedIsTooSmoothAndCorrectedIsNot) {
  double published = 0.0, corrected = 0.0;
  for (std::uint64_t seed = 0; seed < 2; ++seed) {
    ScatteredScene scene(2.5, 128, 0.05, seed);
    scene.add_border();
    const double target = axis_dimension(scene.truth);
    const auto roughness = [&](const BarycentreOptions& options) {
      double sum = 0.0;
      for (const Grid<float>& draw : draws_of(scene.request, [&](const SurfaceRequest& request) {
             SerialExecutor serial;
             return reconstruct_barycentre(scene.samples, request, options, serial);
           }))
        sum += axis_dimension(draw) - target;
      return sum / 3.0;
    };
    published += roughness({}) / 2.0;
    corrected += roughness(corrected_barycentre()) / 2.0;
  }
  EXPECT_LT(published, -0.11);
  EXPECT_NEAR(corrected, 0.0, 0.05);
}

TEST(Barycentre, IsTheSameEveryTimeAndWithAnyThreads) {
  const ScatteredScene scene(2.5, 40, 0.1, 6);
  SerialExecutor serial;
  Backwards backwards;
  const auto a = reconstruct_barycentre(scene.samples, scene.request, corrected_barycentre(), serial);
  const auto b = reconstruct_barycentre(scene.samples, scene.request, corrected_barycentre(), backwards);
  EXPECT_TRUE(same(a->mean_m, b->mean_m));
  EXPECT_TRUE(same(a->sd_m, b->sd_m));
}

TEST(Barycentre, SamplesAwayFromTheGridLeaveItUnknown) {
  SurfaceRequest request;
  request.grid = {10, 10, 1.0};
  SerialExecutor serial;
  const auto estimate = reconstruct_barycentre({{50, 60, 50}, {50, 50, 60}, {1, 2, 3}, {0, 0, 0}}, request, serial);
  ASSERT_TRUE(estimate) << estimate.error().message;
  EXPECT_EQ(estimate->iterations, 0);
  for (const float z : estimate->mean_m) EXPECT_TRUE(std::isnan(z));
}

TEST(Barycentre, SaysWhatIsWrong) {
  const ScatteredScene scene(2.5, 20, 0.1, 7);
  SerialExecutor serial;
  const auto message = [&](const BarycentreOptions& options) {
    const auto result = reconstruct_barycentre(scene.samples, scene.request, options, serial);
    EXPECT_FALSE(result);
    EXPECT_EQ(result.error().kind, ErrorKind::usage);
    return result.error().message;
  };
  BarycentreOptions options;
  options.insertions = -2;
  EXPECT_EQ(message(options), "barycentre: expected 0 to 200000000 insertions, found -2");
  options = {};
  options.centres = {{0, 0, {2.5, 0.1}}, {1, 1, {3.5, 0.1}}};
  EXPECT_EQ(message(options), "influence centre 1: expected 2 < D < 3, found D = 3.5");
}

}  // namespace
}  // namespace scree::fractal
