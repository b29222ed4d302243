#include "fractal/anisotropy.hpp"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <numbers>

#include "core/random.hpp"
#include "fractal/azimuth_null.hpp"
#include "fractal/directed_increments.hpp"
#include "fractal/fbm_points.hpp"
#include "fractal/surface.hpp"

namespace scree::fractal {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr double kPi = std::numbers::pi;

struct Scene {
  double noise = 0.0;  ///< of the rms change over one cell
  double empty = 0.0;  ///< share of unknown cells
};

Result<Anisotropy> analyse(const Grid<float>& z, float variance_m2 = 0.0F) {
  SerialExecutor serial;
  return analyse_anisotropy(z, 0.1, Grid<float>(z.rows(), z.columns(), variance_m2),
                            Grid<std::uint16_t>(z.rows(), z.columns(), 0), serial);
}

/// Every `stretch`-th row of a surface: compressed along y, hence roughest along y, by that factor.
Grid<float> surface(double hurst, int side, int stretch, std::uint64_t seed) {
  const Grid<float> dense = *fbm_surface({3.0 - hurst, 0.1}, side * stretch, side, 0.1, seed);
  Grid<float> z(side, side);
  for (int r = 0; r < side; ++r)
    for (int c = 0; c < side; ++c) z(r, c) = dense(r * stretch, c);
  return z;
}

Anisotropy analyse(Grid<float> z, double hurst, const Scene& scene, std::uint64_t seed) {
  const double sigma = scene.noise * FractalLaw{3.0 - hurst, 0.1}.rms_change_m(0.1);
  for (int r = 0; r < z.rows(); ++r)
    for (int c = 0; c < z.columns(); ++c) {
      z(r, c) += static_cast<float>(sigma * random_normals(seed, 10, c, r)[0]);
      if (to_uniform(random_words(seed, 11, c, r)[0]) < scene.empty) z(r, c) = kNaN;
    }
  return *analyse(z, static_cast<float>(sigma * sigma));
}

double share_significant(double hurst, int side, int stretch, int surfaces, const Scene& scene = {}) {
  int significant = 0;
  for (int i = 0; i < surfaces; ++i) {
    const auto seed = static_cast<std::uint64_t>(i);
    significant += analyse(surface(hurst, side, stretch, seed), hurst, scene, seed).significant;
  }
  return static_cast<double>(significant) / surfaces;
}

/// Difference of two directions, which are the same after half a turn.
double turn_between(double a, double b) {
  return std::abs(std::remainder(a - b, kPi));
}

Grid<float> quarter_turned(const Grid<float>& z) {  // what was along +x is along +y
  Grid<float> out(z.columns(), z.rows());
  for (int r = 0; r < z.rows(); ++r)
    for (int c = 0; c < z.columns(); ++c) out(c, z.rows() - 1 - r) = z(r, c);
  return out;
}

TEST(PairCounts, AgreeWithBruteForceAcrossWordBorders) {
  constexpr int kRows = 9, kColumns = 75, kReach = 5;
  const auto bit = [](std::uint64_t stream, int r, int c) {
    return r >= 0 && r < kRows && c >= 0 && c < kColumns && to_uniform(random_words(3, stream, c, r)[0]) < 0.6;
  };
  BitPlane first(kRows, kColumns), second(kRows, kColumns);
  for (int r = 0; r < kRows; ++r)
    for (int c = 0; c < kColumns; ++c) {
      if (bit(1, r, c)) first.set(r, c);
      if (bit(2, r, c)) second.set(r, c);
    }
  const std::vector<double> counts = pair_counts(first, second, kReach);
  for (int oy = -kReach; oy <= kReach; ++oy)
    for (int ox = -kReach; ox <= kReach; ++ox) {
      int expected = 0;
      for (int r = 0; r < kRows; ++r)
        for (int c = 0; c < kColumns; ++c) expected += bit(1, r, c) && bit(2, r + oy, c + ox);
      EXPECT_EQ(counts[static_cast<std::size_t>((oy + kReach) * (2 * kReach + 1) + ox + kReach)], expected);
    }
}

// Rate in [.03, .08] at nominal .05; n = 500 (64 × 64: 150) surfaces, so a test that keeps to it passes within
// .03 − 2.6·.0076 = .010 and .08 + 2.6·.0121 = .112 (.138) with probability .99 or more.
TEST(ContrastTest, FalseAlarmsKeepTheNominalRate) {
  for (const double hurst : {0.2, 0.5, 0.8}) {
    const double small = share_significant(hurst, 21, 1, 500);
    EXPECT_GT(small, 0.010) << hurst;
    EXPECT_LT(small, 0.112) << hurst;
  }
  EXPECT_LT(share_significant(0.35, 64, 1, 150), 0.138);
}

// As above; 30 % of the cells empty, noise 30 % of the rms change over a cell.
TEST(ContrastTest, HolesAndKnownNoiseRaiseNoFalseAlarms) {
  for (const double hurst : {0.35, 0.7}) EXPECT_LT(share_significant(hurst, 21, 1, 500, {0.3, 0.3}), 0.112) << hurst;
}

// Target .95; measured .997 – 1.000 (n = 1000), so 300 surfaces miss it with probability below 1e-6.
TEST(ContrastTest, FindsAStretchByTwoOnTwentyOneCells) {
  for (const double hurst : {0.35, 0.5, 0.7, 0.9}) EXPECT_GE(share_significant(hurst, 21, 2, 300), 0.95) << hurst;
}

// Exact fBm at the places of a lattice that is compressed by 2 along 30° from +x: roughest along 30°. n = 60 surfaces
// of 21 × 21 cells; the standard deviation of one direction is .065 rad, that of one log strength .12 (measured),
// bounds are 4 standard errors and .03 of bias.
TEST(Anisotropy, DirectionIsThatOfTheLargestRoughnessAndStrengthIsTheStretch) {
  constexpr int kSide = 21, kSurfaces = 60;
  constexpr double kAngle = kPi / 6.0;
  std::vector<double> x, y;
  for (int r = 0; r < kSide; ++r)
    for (int c = 0; c < kSide; ++c) {
      const double along = 0.1 * (c * std::cos(kAngle) + r * std::sin(kAngle));
      const double across = 0.1 * (r * std::cos(kAngle) - c * std::sin(kAngle));
      x.push_back(2.0 * along);
      y.push_back(across);
    }
  const FbmPoints law = *FbmPoints::make({2.4, 0.1}, x, y);
  double turn = 0.0, log_strength = 0.0;
  for (int i = 0; i < kSurfaces; ++i) {
    const std::vector<double> heights = law.draw(static_cast<std::uint64_t>(i));
    Grid<float> z(kSide, kSide);
    std::transform(heights.begin(), heights.end(), z.begin(), [](double h) { return static_cast<float>(h); });
    const Anisotropy a = *analyse(z);
    turn += std::remainder(a.direction_rad - kAngle, kPi) / kSurfaces;
    log_strength += std::log(a.strength) / kSurfaces;
    EXPECT_TRUE(a.direction_rad >= 0.0 && a.direction_rad < kPi);
  }
  EXPECT_NEAR(turn, 0.0, 0.03 + 4.0 * 0.065 / std::sqrt(kSurfaces));
  EXPECT_NEAR(log_strength, std::log(2.0), 0.03 + 4.0 * 0.12 / std::sqrt(kSurfaces));
}

TEST(Anisotropy, AQuarterTurnTurnsTheDirectionAndMovesTheAzimuths) {
  const Grid<float> z = surface(0.6, 33, 2, 5);
  const Anisotropy a = *analyse(z), b = *analyse(quarter_turned(z));
  EXPECT_LT(turn_between(a.direction_rad, kPi / 2.0), 0.2);  // compressed along y
  EXPECT_LT(turn_between(b.direction_rad, a.direction_rad + kPi / 2.0), 1e-6);
  EXPECT_NEAR(a.chi_square, b.chi_square, 1e-4 * a.chi_square);
  EXPECT_NEAR(a.strength, b.strength, 1e-5);
  EXPECT_NEAR(a.index_v, b.index_v, 1e-5);
  for (std::size_t i = 0; i < kAzimuthCount; ++i) EXPECT_NEAR(a.hurst[i], b.hurst[(i + 6) % kAzimuthCount], 1e-5);
}

TEST(Anisotropy, PlanesAndUnitsChangeNothing) {
  const Grid<float> z = surface(0.6, 33, 1, 6);
  Grid<float> tilted = z, scaled = z;
  for (int r = 0; r < 33; ++r)
    for (int c = 0; c < 33; ++c) {
      tilted(r, c) += 0.05F * static_cast<float>(c) - 0.03F * static_cast<float>(r) + 2.0F;
      scaled(r, c) *= 10.0F;
    }
  const Anisotropy a = *analyse(z, 1e-5F);
  for (const Anisotropy& b : {*analyse(tilted, 1e-5F), *analyse(scaled, 1e-3F)}) {
    EXPECT_NEAR(a.chi_square, b.chi_square, 1e-3);
    EXPECT_NEAR(a.direction_rad, b.direction_rad, 1e-3);
    EXPECT_NEAR(a.index_v, b.index_v, 1e-3);
  }
}

// Every direction of isotropic ground has its H: n = 40 surfaces of 64 × 64 cells, sd of one direction .04 (measured).
TEST(DirectionalHurst, IsUnbiasedInEveryDirection) {
  constexpr int kSurfaces = 40;
  for (const double hurst : {0.3, 0.7}) {
    std::array<double, kAzimuthCount> mean{};
    for (int i = 0; i < kSurfaces; ++i) {
      const Anisotropy a = *analyse(surface(hurst, 64, 1, static_cast<std::uint64_t>(i)));
      for (std::size_t k = 0; k < kAzimuthCount; ++k) mean[k] += a.hurst[k] / kSurfaces;
      EXPECT_DOUBLE_EQ(a.azimuth_lag_m, 1.6);
    }
    for (const double h : mean) EXPECT_NEAR(h, hurst, 0.01 + 4.0 * 0.04 / std::sqrt(kSurfaces)) << hurst;
  }
}

// As the contrast test's rates; n = 400, .05 ± 4·.011.
TEST(IndexV, ExceedsItsNullQuantileAtTheNominalRate) {
  for (const double hurst : {0.35, 0.7}) {
    int beyond = 0;
    for (int i = 0; i < 400; ++i)
      beyond += analyse(surface(hurst, 32, 1, static_cast<std::uint64_t>(i)))->v_significant;
    EXPECT_NEAR(beyond / 400.0, 0.05, 0.044) << hurst;
  }
}

// A stretch changes C(θ), not H(θ): .07 – .09 of 1000 surfaces exceed the quantile (anisotropy_bench). n = 200: .09 + 3
// s.e. of .02.
TEST(IndexV, LeavesAStretchAlone) {
  int beyond = 0;
  for (int i = 0; i < 200; ++i) beyond += analyse(surface(0.7, 32, 2, static_cast<std::uint64_t>(i)))->v_significant;
  EXPECT_LT(beyond / 200.0, 0.15);
}

// The sum of a profile along x with H = .3 and one along y with H = .6 has H = .6 along y and .3 elsewhere [X09].
TEST(IndexV, SeesAnExponentThatDependsOnDirection) {
  int seen = 0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const Grid<float> x = *fbm_surface({2.7, 0.1}, 1, 64, 0.1, 2 * seed);
    const Grid<float> y = *fbm_surface({2.4, 0.2}, 64, 1, 0.1, 2 * seed + 1);
    Grid<float> z(64, 64);
    for (int r = 0; r < 64; ++r)
      for (int c = 0; c < 64; ++c) z(r, c) = x(0, c) + y(r, 0);
    seen += analyse(z)->v_significant;
  }
  EXPECT_GE(seen, 15);
}

TEST(IndexV, NullFallsWithTheWindowAndWithH) {
  EXPECT_TRUE(std::isnan(index_v_null95(15.9, 0.5)));
  for (double side = 16.0; side < 2000.0; side *= 1.3)
    for (double hurst = 0.02; hurst < 0.97; hurst += 0.05) {
      EXPECT_GT(index_v_null95(side, hurst), index_v_null95(side * 1.3, hurst)) << side << " " << hurst;
      EXPECT_GE(index_v_null95(side, hurst), index_v_null95(side, hurst + 0.05)) << side << " " << hurst;
    }
}

TEST(Anisotropy, SmallWindowsHaveNoIndexAndTinyOnesAreRefused) {
  const Anisotropy small = *analyse(surface(0.5, 12, 1, 1));
  EXPECT_TRUE(std::isnan(small.index_v) && std::isnan(small.index_v_null95) && !small.v_significant);
  const auto tiny = analyse(surface(0.5, 6, 1, 1));
  ASSERT_FALSE(tiny);
  EXPECT_EQ(tiny.error().kind, ErrorKind::bad_data);
}

TEST(Anisotropy, BadInputIsRefused) {
  SerialExecutor serial;
  const Grid<float> z = surface(0.5, 21, 1, 1), flat(21, 21, 1.0F), empty(21, 21, kNaN);
  const Grid<std::uint16_t> hits(21, 21, 0);
  EXPECT_EQ(analyse_anisotropy(z, 0.1, Grid<float>(20, 21), hits, serial).error().kind, ErrorKind::usage);
  EXPECT_EQ(analyse_anisotropy(z, 0.0, Grid<float>(21, 21), hits, serial).error().kind, ErrorKind::usage);
  EXPECT_EQ(analyse(flat).error().kind, ErrorKind::bad_data);
  EXPECT_EQ(analyse(empty).error().kind, ErrorKind::bad_data);
}

}  // namespace
}  // namespace scree::fractal
