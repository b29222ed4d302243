#include "fractal/structure_function.hpp"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <string>
#include <vector>

#include "core/random.hpp"
#include "fractal/surface.hpp"

namespace scree::fractal {
namespace {

/// `count` points at random places of a square of side √count, heights of rough waves.
PointColumns scattered(int count, std::uint64_t seed = 1) {
  PointColumns points;
  const double side = std::sqrt(count);
  for (int i = 0; i < count; ++i) {
    const auto words = random_words(seed, 1, i, 0);
    const double x = side * to_uniform(words[0]), y = side * to_uniform(words[1]);
    const double z = 3.0 + std::sin(0.7 * x) * std::cos(0.4 * y) + 0.2 * random_normals(seed, 2, i, 0)[0];
    points.push_back(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z));
  }
  return points;
}

PointColumns lattice_points(const Grid<float>& z, double cell_m) {
  PointColumns points;
  for (int r = 0; r < z.rows(); ++r)
    for (int c = 0; c < z.columns(); ++c)
      if (std::isfinite(z(r, c)))
        points.push_back(static_cast<float>(c * cell_m), static_cast<float>(r * cell_m), z(r, c));
  return points;
}

/// 48 × 40 cells of exact fBm, 30 % of them unknown, heights around 100 m.
Grid<float> gappy_surface() {
  auto z = *fbm_surface({2.2, 0.3}, 48, 40, 0.1, 11);
  for (int r = 0; r < z.rows(); ++r)
    for (int c = 0; c < z.columns(); ++c)
      z(r, c) = to_uniform(random_words(3, 3, c, r)[0]) < 0.3 ? NAN : z(r, c) + 100.0F;
  return z;
}

StructureFunction compute(const PointColumns& points, const Annuli& annuli, PairOptions options = {}) {
  SerialExecutor serial;
  auto result = structure_function(points, annuli, options, serial);
  EXPECT_TRUE(result) << result.error().message;
  return *result;
}

StructureFunction compute(const PointColumns& points, const Annuli& annuli, PairRoute route) {
  return compute(points, annuli, PairOptions{.route = route});
}

/// Cuts a loop into many ranges and runs them backwards.
class BackwardsExecutor final : public Executor {
 public:
  void for_ranges(int count, const std::function<void(int, int)>& body) override {
    for (int end = count; end > 0; end -= 3) body(std::max(0, end - 3), end);
  }
};

bool identical(const StructureFunction& a, const StructureFunction& b) {
  return std::equal(a.sums.begin(), a.sums.end(), b.sums.begin(), b.sums.end(), [](const auto& p, const auto& q) {
    return p.count == q.count && p.abs_m == q.abs_m && p.square_m2 == q.square_m2 && p.log_m == q.log_m;
  });
}

const std::vector<Annuli> kLags{uniform_annuli(1.0, 12.0),
                                uniform_annuli(0.37, 9.0),
                                {Annuli::Spacing::uniform, 2.0, 1.5, 6, 0.4},
                                geometric_annuli(0.5, 1.3, 20.0)};

// Exact arithmetic may move only the pairs whose distance is within a few float32 ulp (4e-7 of it) of a border.
TEST(StructureFunction, ReferenceFollowsTheRuleOfThePaper) {
  const PointColumns points = scattered(600);
  for (const Annuli& annuli : kLags) {
    const auto result = compute(points, annuli, PairRoute::reference);
    for (int k = 0; k < annuli.count; ++k) {
      double count = 0, doubtful = 0, abs = 0, square = 0, log = 0;
      for (std::size_t i = 0; i < points.size(); ++i)
        for (std::size_t j = 0; j < i; ++j) {
          const double d = std::hypot(double{points.x_m[i]} - points.x_m[j], double{points.y_m[i]} - points.y_m[j]);
          const double inner = annuli.inner_m(k), outer = annuli.outer_m(k), margin = 2e-6 * (1.0 + d);
          if (std::min(std::abs(d - inner), std::abs(d - outer)) < margin) ++doubtful;
          if (d < inner || d >= outer) continue;
          const double dz = double{points.z_m[i]} - points.z_m[j];
          ++count, abs += std::abs(dz), square += dz * dz, log += std::log(d);
        }
      const PairSums& sums = result.sums[static_cast<std::size_t>(k)];
      EXPECT_LE(std::abs(sums.count - count), doubtful);
      EXPECT_LE(doubtful, 3.0);
      if (sums.count != count) continue;
      EXPECT_NEAR(sums.abs_m, abs, 1e-9 * abs);
      EXPECT_NEAR(sums.square_m2, square, 1e-9 * square);
      EXPECT_NEAR(sums.log_m, log, 1e-6 * count);
    }
  }
}

// Moments: float32 sums of up to 1024 terms between flushes, worst relative error 1024 · 6e-8, typical 32 · 6e-8.
TEST(StructureFunction, VectorisedRoutesCountThePairsOfTheReference) {
  const PointColumns points = scattered(3001);
  for (const Annuli& annuli : kLags) {
    const auto expected = compute(points, annuli, PairRoute::reference);
    for (const PairRoute route : {PairRoute::all_pairs, PairRoute::near_pairs}) {
      const auto found = compute(points, annuli, route);
      for (std::size_t k = 0; k < expected.sums.size(); ++k) {
        const PairSums &e = expected.sums[k], &f = found.sums[k];
        ASSERT_EQ(f.count, e.count) << "annulus " << k;
        EXPECT_NEAR(f.abs_m, e.abs_m, 5e-6 * e.abs_m);
        EXPECT_NEAR(f.square_m2, e.square_m2, 5e-6 * e.square_m2);
        EXPECT_NEAR(f.log_m, e.log_m, 5e-6 * e.count * 3.0);
      }
    }
  }
}

TEST(StructureFunction, EveryRouteIsIndependentOfHowTheWorkIsCut) {
  const PointColumns points = scattered(2000);
  BackwardsExecutor backwards;
  for (const PairRoute route :
       {PairRoute::reference, PairRoute::all_pairs, PairRoute::near_pairs, PairRoute::thinned}) {
    const auto again = structure_function(points, kLags[0], {.route = route}, backwards);
    ASSERT_TRUE(again);
    EXPECT_TRUE(identical(compute(points, kLags[0], route), *again));
  }
  const auto forwards = compute(points, kLags[0], PairRoute::lattice);
  const auto again = structure_function(points, kLags[0], {.route = PairRoute::lattice}, backwards);
  for (std::size_t k = 0; k < forwards.sums.size(); ++k)
    EXPECT_EQ(forwards.sums[k].square_m2, again->sums[k].square_m2);
}

TEST(StructureFunction, FourierRouteIsExactOnLatticeData) {
  const Grid<float> z = gappy_surface();
  const PointColumns points = lattice_points(z, 0.1);
  SerialExecutor serial;
  for (const Annuli& annuli : {uniform_annuli(0.1, 1.7), geometric_annuli(0.1, 1.4, 3.0), uniform_annuli(0.25, 9.0)}) {
    const auto expected = compute(points, annuli, PairRoute::reference);
    const auto found = compute(points, annuli, PairOptions{.route = PairRoute::lattice, .spacing_m = 0.1});
    const auto grid = lattice_structure_function(z, 0.1, annuli, serial);
    ASSERT_TRUE(grid);
    EXPECT_FALSE(found.has_absolute);
    for (std::size_t k = 0; k < expected.sums.size(); ++k) {
      const PairSums& e = expected.sums[k];
      ASSERT_EQ(found.sums[k].count, e.count) << "annulus " << k;
      EXPECT_NEAR(found.sums[k].square_m2, e.square_m2, 1e-9 * e.square_m2);
      EXPECT_NEAR(grid->sums[k].square_m2, e.square_m2, 1e-9 * e.square_m2);
      EXPECT_EQ(grid->sums[k].count, e.count);
      EXPECT_NEAR(found.sums[k].log_m, e.log_m, 1e-6 * e.count);
      EXPECT_TRUE(std::isnan(found.sums[k].abs_m));
    }
  }
}

TEST(StructureFunction, FourierRouteAddsPointsThatShareACell) {
  PointColumns points = scattered(300), snapped;
  for (std::size_t i = 0; i < points.size(); ++i)
    snapped.push_back(std::round(points.x_m[i]), std::round(points.y_m[i]), points.z_m[i]);
  const auto expected = compute(snapped, kLags[0], PairRoute::reference);
  const auto found = compute(snapped, kLags[0], PairOptions{.route = PairRoute::lattice, .spacing_m = 1.0});
  for (std::size_t k = 0; k < expected.sums.size(); ++k) {
    EXPECT_EQ(found.sums[k].count, expected.sums[k].count);
    EXPECT_NEAR(found.sums[k].square_m2, expected.sums[k].square_m2, 1e-9 * expected.sums[k].square_m2);
  }
}

TEST(StructureFunction, TurningMirroringAndScalingByTwoChangeNothingElse) {
  const PointColumns points = scattered(1500);
  PointColumns turned;
  for (std::size_t i = 0; i < points.size(); ++i) turned.push_back(-points.y_m[i], points.x_m[i], 8.0F * points.z_m[i]);
  const auto before = compute(points, kLags[1], PairRoute::all_pairs);
  const auto after = compute(turned, kLags[1], PairRoute::all_pairs);
  for (std::size_t k = 0; k < before.sums.size(); ++k) {
    EXPECT_EQ(after.sums[k].count, before.sums[k].count);
    EXPECT_EQ(after.sums[k].abs_m, 8.0 * before.sums[k].abs_m);
    EXPECT_EQ(after.sums[k].square_m2, 64.0 * before.sums[k].square_m2);
  }
}

// The mean over n = 60 seeds must agree with all pairs within 4 standard errors in each of 11 annuli: false-alarm rate
// 11 · 1.8e-4 (t with 59 degrees of freedom).
TEST(StructureFunction, ThinningIsUnbiased) {
  constexpr int kSeeds = 60;
  const PointColumns points = scattered(3000);
  const auto all = compute(points, kLags[0], PairRoute::near_pairs);
  std::vector<double> sum(all.sums.size()), sum2(all.sums.size());
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const auto some = compute(points, kLags[0], {.route = PairRoute::thinned, .spacing_m = 1.0, .seed = seed});
    for (std::size_t k = 0; k < sum.size(); ++k) {
      const double share = std::min(1.0, 2.0 * std::pow(4.0, -std::floor(std::log2(static_cast<double>(k) + 1.0))));
      // Unbiased are the sums over (share kept)²; their ratio is only nearly so.
      const double value = some.sums[k].square_m2 / (share * share) / all.sums[k].square_m2;
      sum[k] += value, sum2[k] += value * value;
    }
  }
  EXPECT_NEAR(sum[0], kSeeds, 5e-6 * kSeeds);  // nothing is thinned in the first octave
  for (std::size_t k = 1; k < sum.size(); ++k) {
    const double mean = sum[k] / kSeeds, error = std::sqrt((sum2[k] / kSeeds - mean * mean) / (kSeeds - 1));
    EXPECT_LT(std::abs(mean - 1.0), 4.0 * error) << "annulus " << k;
  }
}

TEST(StructureFunction, ThinningLooksAtNumbersOfPairsThatGrowLikeTheNumberOfPoints) {
  const PairOptions options{.route = PairRoute::thinned, .spacing_m = 1.0};
  const auto few = compute(scattered(4000), uniform_annuli(1.0, 15.0), options);
  const auto many = compute(scattered(16000), uniform_annuli(1.0, 30.0), options);
  EXPECT_LT(static_cast<double>(many.pairs_visited), 5.0 * static_cast<double>(few.pairs_visited));
}

std::string message_of(const PointColumns& points, const Annuli& annuli, const PairOptions& options = {}) {
  SerialExecutor serial;
  const auto result = structure_function(points, annuli, options, serial);
  return result ? "" : result.error().message;
}

TEST(StructureFunction, RefusesWhatHasNoAnswer) {
  const PointColumns good = scattered(20);
  PointColumns one, uneven = good, infinite = good, stacked;
  one.push_back(0, 0, 0);
  uneven.x_m.pop_back();
  infinite.z_m[3] = std::numeric_limits<float>::infinity();
  for (int i = 0; i < 5; ++i) stacked.push_back(1, 1, static_cast<float>(i));
  EXPECT_NE(message_of(one, kLags[0]).find("at least 2"), std::string::npos);
  EXPECT_NE(message_of(uneven, kLags[0]).find("19 x, 20 y"), std::string::npos);
  EXPECT_NE(message_of(infinite, kLags[0]).find("finite"), std::string::npos);
  EXPECT_NE(message_of(stacked, kLags[0], {.route = PairRoute::lattice}).find("different positions"),
            std::string::npos);
  EXPECT_EQ(compute(stacked, kLags[0]).sums[0].count, 0.0);
  EXPECT_NE(message_of(good, uniform_annuli(0.0, 5.0)), "");
  EXPECT_NE(message_of(good, uniform_annuli(2.0, 1.0)).find("found 0"), std::string::npos);
  EXPECT_NE(message_of(good, {Annuli::Spacing::uniform, 1.0, 1.0, 3, 0.6}).find("overlap"), std::string::npos);
  EXPECT_NE(message_of(good, {Annuli::Spacing::geometric, 1.0, 0.9, 3, 0.1}).find("ratio > 1"), std::string::npos);
  EXPECT_NE(message_of(good, kLags[0], {.route = PairRoute::lattice, .spacing_m = 1e-6}).find("coarser"),
            std::string::npos);
  EXPECT_NE(message_of(good, kLags[0], {.spacing_m = -1.0}), "");
  SerialExecutor serial;
  EXPECT_FALSE(lattice_structure_function(Grid<float>(4, 4, NAN), 1.0, kLags[0], serial));
  EXPECT_FALSE(lattice_structure_function(Grid<float>(4, 4, 0.0F), 0.0, kLags[0], serial));
}

}  // namespace
}  // namespace scree::fractal
