#include "fractal/dimension_map.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <gtest/gtest.h>
#include <limits>

#include "core/random.hpp"
#include "fractal/box_sum.hpp"
#include "fractal/dimension_tables.hpp"
#include "fractal/surface.hpp"

namespace scree::fractal {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

/// Cuts every range into pieces of three, last first: what a pool may do.
class ScrambledExecutor final : public Executor {
 public:
  void for_ranges(int count, const std::function<void(int, int)>& body) override {
    for (int end = count; end > 0; end -= 3) body(std::max(0, end - 3), end);
  }
};

struct Input {
  Grid<float> height, variance;
  Grid<std::uint16_t> hits;
  explicit Input(Grid<float> z, float noise_variance = 0.0F, std::uint16_t k = 0)
      : height(std::move(z)),
        variance(height.rows(), height.columns(), noise_variance),
        hits(height.rows(), height.columns(), k) {}
};

DimensionMap map_of(const Input& input, DimensionMapConfig config = {}) {
  DimensionMapper mapper(config);
  SerialExecutor serial;
  DimensionMap map;
  mapper.update(input.height, input.variance, input.hits, serial, map);
  return map;
}

Grid<float> surface(double dimension, int side, std::uint64_t seed, double amplitude_m = 0.1) {
  return *fbm_surface({dimension, amplitude_m}, side, side, 0.1, seed);
}

TEST(BoxSum, AgreesWithBruteForceAtEveryBorder) {
  BoxSum box;
  BoxScratch scratch;
  for (const int radius : {0, 1, 3, 10}) {
    box.resize(13, 17, radius);
    for (int repeat = 0; repeat < 2; ++repeat) {  // the second pass finds the buffers used
      for (int r = 0; r < 13; ++r)
        for (int c = 0; c < 17; ++c)
          box.row(r)[static_cast<std::size_t>(c)] = static_cast<float>((r * 31 + c * 7) % 11);
      box.sum(scratch);
      for (int r = 0; r < 13; ++r)
        for (int c = 0; c < 17; ++c) {
          int expected = 0;
          for (int y = std::max(0, r - radius); y <= std::min(12, r + radius); ++y)
            for (int x = std::max(0, c - radius); x <= std::min(16, c + radius); ++x) expected += (y * 31 + x * 7) % 11;
          ASSERT_EQ(box.sums()(r, c), static_cast<float>(expected)) << radius << " " << r << " " << c;
        }
    }
  }
}

// E|u − u'| over a unit square is 0.5214054…, E|u − u'|² is 1/3; far blocks approach the power law with the curvature
// correction H²/3·|o|^(2H−2) of two uniform displacements.
TEST(MeanVariogram, HasItsClosedFormValues) {
  EXPECT_NEAR(mean_variogram(Support::block, 0.5, 0, 0), 0.52140543316472, 1e-9);
  EXPECT_NEAR(mean_variogram(Support::block, 0.999999, 0, 0), 1.0 / 3.0, 1e-5);
  EXPECT_NEAR(mean_variogram(Support::block, 0.999999, 3, 2), 13.0 + 1.0 / 3.0, 1e-4);
  EXPECT_NEAR(mean_variogram(Support::block, 0.4, 20, 0), std::pow(20.0, 0.8) * (1.0 + 0.16 / 3.0 / 400.0), 1e-5);
  EXPECT_DOUBLE_EQ(mean_variogram(Support::centre_point, 0.3, 3, 4), std::pow(25.0, 0.3));
}

TEST(Increments, AnnihilatePlanesAndHaveTheirNoiseGain) {
  for (const IncrementClass& increment_class : kClasses)
    for (const Increment& increment : increment_class.increments()) {
      int sum = 0, x = 0, y = 0, squares = 0;
      for (const auto& p : increment) {
        sum += p.weight, x += p.weight * p.dx, y += p.weight * p.dy, squares += p.weight * p.weight;
        EXPECT_LE(std::max(std::abs(p.dx), std::abs(p.dy)), kIncrementReach);
      }
      EXPECT_TRUE(sum == 0 && x == 0 && y == 0);
      EXPECT_EQ(squares, increment_class.noise_gain());
    }
}

TEST(DimensionMap, ExactPlaneIsAsSmoothAsTheScaleGoesAndFlagged) {
  Grid<float> flat(40, 40, 1.5F), tilted(40, 40);
  for (int r = 0; r < 40; ++r)
    for (int c = 0; c < 40; ++c) tilted(r, c) = 0.25F * static_cast<float>(c) - 0.5F * static_cast<float>(r);  // exact
  for (const auto& z : {flat, tilted}) {
    const DimensionMap map = map_of(Input(z));
    EXPECT_FLOAT_EQ(map.dimension(20, 20), 2.02F);
    EXPECT_EQ(map.amplitude_m(20, 20), 0.0F);
    EXPECT_EQ(map.flags(20, 20), kAtBound);
  }
}

TEST(DimensionMap, NoisyPlaneIsNoiseLimitedWhenTheNoiseIsKnown) {
  Grid<float> z(60, 60);
  for (int r = 0; r < 60; ++r)
    for (int c = 0; c < 60; ++c)
      z(r, c) = 0.03F * static_cast<float>(c) + 0.02F * static_cast<float>(random_normals(1, 2, c, r)[0]);
  const DimensionMap known = map_of(Input(z, 4e-4F)), ignored = map_of(Input(z));
  int limited = 0, cells = 0;
  for (int r = 14; r < 46; r += 8)
    for (int c = 14; c < 46; c += 8) limited += (known.flags(r, c) & kNoiseLimited) != 0, ++cells;
  EXPECT_GE(limited, cells * 9 / 10);          // the rest: noise that looks 5 % above its stated variance by chance
  EXPECT_GT(ignored.dimension(30, 30), 2.9F);  // white noise taken for ground is as rough as the scale goes
}

TEST(DimensionMap, AddingAPlaneChangesNothing) {
  for (const int hits : {0, 1, 5, 60000}) {
    const Grid<float> z = surface(2.4, 48, 3);
    Grid<float> tilted = z;
    for (int r = 0; r < 48; ++r)
      for (int c = 0; c < 48; ++c) tilted(r, c) += 0.05F * static_cast<float>(c) - 0.03F * static_cast<float>(r) + 2.0F;
    const DimensionMap a = map_of(Input(z, 1e-5F, static_cast<std::uint16_t>(hits))),
                       b = map_of(Input(tilted, 1e-5F, static_cast<std::uint16_t>(hits)));
    for (std::size_t i = 0; i < z.size(); ++i) ASSERT_NEAR(a.dimension[i], b.dimension[i], 1e-4);
  }
}

TEST(DimensionMap, DependsOnRatiosOfHeightsOnly) {
  Grid<float> z = surface(2.3, 48, 4), scaled = z;
  for (float& v : scaled) v *= 10.0F;
  for (const float sigma : {0.0F, 0.004F}) {
    const DimensionMap a = map_of(Input(z, sigma * sigma)), b = map_of(Input(scaled, 100.0F * sigma * sigma));
    for (std::size_t i = 0; i < z.size(); ++i) {
      ASSERT_NEAR(a.dimension[i], b.dimension[i], 1e-5);
      ASSERT_NEAR(10.0F * a.amplitude_m[i], b.amplitude_m[i], 1e-4F * b.amplitude_m[i]);
      ASSERT_EQ(a.flags[i], b.flags[i]);
    }
  }
}

TEST(DimensionMap, DoesNotDependOnHowTheWorkIsCut) {
  Grid<float> z = surface(2.5, 50, 5);
  for (int r = 20; r < 27; ++r) z(r, 30) = kNaN;
  const Input input(z, 1e-5F, 2);
  DimensionMapper mapper({});
  ScrambledExecutor scrambled;
  DimensionMap cut;
  mapper.update(input.height, input.variance, input.hits, scrambled, cut);
  mapper.update(input.height, input.variance, input.hits, scrambled, cut);  // used buffers
  const DimensionMap whole = map_of(input);
  EXPECT_EQ(std::memcmp(cut.dimension.data(), whole.dimension.data(), z.size() * sizeof(float)), 0);
  EXPECT_EQ(std::memcmp(cut.amplitude_m.data(), whole.amplitude_m.data(), z.size() * sizeof(float)), 0);
  EXPECT_EQ(cut.flags, whole.flags);
}

TEST(DimensionMap, EmptyAndSparseWindowsAreFlagged) {
  Grid<float> z(60, 60, kNaN);
  const DimensionMap empty = map_of(Input(z));
  EXPECT_TRUE(std::all_of(empty.flags.begin(), empty.flags.end(), [](auto f) { return f == kTooLittleData; }));
  EXPECT_TRUE(std::isnan(empty.dimension(30, 30)));
  const Grid<float> patch = surface(2.5, 20, 6);
  for (int r = 0; r < 20; ++r)
    for (int c = 0; c < 20; ++c) z(r + 20, c + 20) = patch(r, c);
  const DimensionMap map = map_of(Input(z));
  EXPECT_EQ(map.flags(5, 5), kTooLittleData);
  EXPECT_EQ(map.flags(30, 30) & kTooLittleData, 0);
  EXPECT_TRUE(std::isfinite(map.dimension_sigma(30, 30)));
}

struct Moments {
  double mean = 0.0, rmse = 0.0, coverage = 0.0, rejected = 0.0, anisotropic = 0.0, log_amplitude = 0.0;
};

struct Sampling {
  double noise = 0.0;      ///< of the rms change over one cell
  double empty = 0.0;      ///< share of unknown cells
  std::uint16_t hits = 0;  ///< 0 centre, 1 a random point of a 9 × 9 lattice in the cell, 65535 their mean
};

/// Centre cell of `surfaces` windows of 21 × 21 cells with their whole reach.
Moments study(double dimension, int surfaces, Sampling sampling) {
  constexpr int kSide = 29, kFine = 9;
  const FractalLaw law{dimension, 0.1};
  const double sigma = sampling.noise * law.rms_change_m(0.1);
  Moments m;
  for (int i = 0; i < surfaces; ++i) {
    const auto seed = static_cast<std::uint64_t>(i);
    const int fine = sampling.hits == 0 ? 1 : kFine;
    const Grid<float> dense = *fbm_surface(law, kSide * fine, kSide * fine, 0.1 / fine, seed);
    Grid<float> z(kSide, kSide, 0.0F);
    for (int r = 0; r < kSide; ++r)
      for (int c = 0; c < kSide; ++c) {
        const auto words = random_words(seed, 9, c, r);
        if (sampling.hits == 65535) {
          double sum = 0.0;
          for (int y = 0; y < fine; ++y)
            for (int x = 0; x < fine; ++x) sum += dense(r * fine + y, c * fine + x);
          z(r, c) = static_cast<float>(sum / (fine * fine));
        } else {
          z(r, c) = dense(r * fine + static_cast<int>(words[0] % static_cast<unsigned>(fine)),
                          c * fine + static_cast<int>(words[1] % static_cast<unsigned>(fine)));
        }
        z(r, c) += static_cast<float>(sigma * random_normals(seed, 10, c, r)[0]);
        if (to_uniform(words[2]) < sampling.empty) z(r, c) = kNaN;
      }
    const DimensionMap map = map_of(Input(z, static_cast<float>(sigma * sigma), sampling.hits));
    const double error = map.dimension(14, 14) - dimension;
    m.mean += error / surfaces;
    m.rmse += error * error / surfaces;
    m.coverage += (std::abs(error) < 1.96 * map.dimension_sigma(14, 14) ? 1.0 : 0.0) / surfaces;
    m.rejected += (map.flags(14, 14) & kNotFractal ? 1.0 : 0.0) / surfaces;
    m.anisotropic += (map.flags(14, 14) & kAnisotropic ? 1.0 : 0.0) / surfaces;
    m.log_amplitude += std::log(map.amplitude_m(14, 14) / 0.1) / surfaces;
  }
  m.rmse = std::sqrt(m.rmse);
  return m;
}

// 21 × 21 cells, exact fBm. Bounds: RMSE 1.1 × the Cramér–Rao bound of the window (.053 .051 .048 .041 .025 for a plane
// drift), times the 3-s.e. factor of a standard deviation from n surfaces, 1 + 3/√(2n) = 1.15 (n = 200); bias 0.01 + 3
// s.e.; at most .004 of the cells flagged anisotropic (nominal
// .001), 5 in 200 with probability 1e-3; coverage of the 95 % interval at least .95 − 3·√(.95·.05/n) = .904.
// False-alarm rate about 1e-3 a bound.
TEST(DimensionMap, ReachesTheCramerRaoBoundOnFullWindows) {
  constexpr int kSurfaces = 200;
  const double bound[] = {0.053, 0.051, 0.048, 0.041, 0.025};
  for (int i = 0; i < 5; ++i) {
    const Moments m = study(2.1 + 0.2 * i, kSurfaces, {});
    EXPECT_LT(m.rmse, 1.15 * 1.1 * bound[i] + (i == 4 ? 0.003 : 0.0)) << "D = " << 2.1 + 0.2 * i;
    EXPECT_LT(std::abs(m.mean), 0.01 + 3.0 * bound[i] / std::sqrt(kSurfaces)) << "D = " << 2.1 + 0.2 * i;
    EXPECT_GT(m.coverage, 0.904) << "D = " << 2.1 + 0.2 * i;
    EXPECT_LT(m.rejected, 0.06) << "D = " << 2.1 + 0.2 * i;
    EXPECT_LT(m.anisotropic, 0.025) << "D = " << 2.1 + 0.2 * i;
  }
}

// Noise of 30 % of the step, known, and 30 % of the cells empty: Cramér–Rao .085 .061 .032 at D = 2.1 2.5 2.9; the map
// may lose 1.6 times to it (n = 150: factor 1.17).
TEST(DimensionMap, HandlesKnownNoiseAndGaps) {
  const double bound[] = {0.085, 0.061, 0.032};
  for (int i = 0; i < 3; ++i) {
    const Moments m = study(2.1 + 0.4 * i, 150, {0.3, 0.3, 0});
    EXPECT_LT(m.rmse, 1.17 * 1.6 * bound[i]) << "D = " << 2.1 + 0.4 * i;
    EXPECT_LT(std::abs(m.mean), 0.02 + 3.0 * 1.6 * bound[i] / std::sqrt(150.0)) << "D = " << 2.1 + 0.4 * i;
    EXPECT_GT(m.coverage, 0.897) << "D = " << 2.1 + 0.4 * i;
    EXPECT_LT(m.rejected, 0.06) << "D = " << 2.1 + 0.4 * i;
    EXPECT_LT(m.anisotropic, 0.025) << "D = " << 2.1 + 0.4 * i;
  }
}

// Cells that hold one random point or the mean of the cell. 9 × 9 positions stand for a continuum, which costs up to
// .03 at D = 2.8 (a mean over a lattice of points keeps γ̄(0)/162 of variance). n = 40 surfaces, sd of D at most .09: 3
// s.e. = .043.
TEST(DimensionMap, KnowsWhatACellStandsFor) {
  for (const double dimension : {2.3, 2.5}) {
    for (const std::uint16_t hits : {std::uint16_t{1}, std::uint16_t{65535}}) {
      const Moments m = study(dimension, 40, {0.0, 0.0, hits});
      EXPECT_LT(std::abs(m.mean), 0.043 + 0.015) << "D = " << dimension << " hits " << hits;
      EXPECT_LT(std::abs(m.log_amplitude), 0.3) << "D = " << dimension << " hits " << hits;
    }
  }
}

// Amplitude at 1 m from a map with cells of 0.1 m: log error within 3 s.e. (n = 200, its sd below .25) of a bias of
// .02.
TEST(DimensionMap, AmplitudeIsTheRmsChangeAtOneMetre) {
  for (const double dimension : {2.3, 2.7})
    EXPECT_LT(std::abs(study(dimension, 200, {}).log_amplitude), 0.02 + 3.0 * 0.25 / std::sqrt(200.0));
}

// Two scales with a break at 2–3 cells are no power law; the chi-square must say so in most windows.
TEST(DimensionMap, ContradictoryEnergiesAreFlagged) {
  int flagged = 0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const Grid<float> z = surface(2.1, 49, seed);
    Grid<float> sum = z;
    for (int r = 0; r < 49; ++r)
      for (int c = 0; c < 49; ++c) sum(r, c) += 0.05F * std::sin(2.2F * static_cast<float>(c));
    flagged += (map_of(Input(sum)).flags(24, 24) & kNotFractal) != 0;
  }
  EXPECT_GE(flagged, 18);
}

}  // namespace
}  // namespace scree::fractal
