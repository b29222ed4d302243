#include "mapping/bend_limit.hpp"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <vector>

#include "core/random.hpp"
#include "fractal/surface.hpp"
#include "tests/support/ground_of.hpp"

namespace scree::mapping {
namespace {

constexpr int kSide = 80, kFine = 8;
constexpr double kCell_m = 0.1, kAmplitude_m = 0.1;

Grid<float> points(double dimension) {
  return *fractal::fbm_surface({dimension, kAmplitude_m}, kSide * kFine, kSide * kFine, kCell_m / kFine, 3);
}

/// What cells hold: the mean height of some places in each.
Grid<float> cells(const Grid<float>& fine, int places) {
  Grid<float> out(kSide, kSide);
  for (int row = 0; row < kSide; ++row)
    for (int column = 0; column < kSide; ++column) {
      const auto words = random_words(7, 0, column, row);
      double sum = 0.0;
      for (int k = 0; k < places; ++k) {
        const auto place = static_cast<int>(words[static_cast<std::size_t>(k)] % (kFine * kFine));
        sum += static_cast<double>(fine(row * kFine + place / kFine, column * kFine + place % kFine));
      }
      out(row, column) = static_cast<float>(sum / places);
    }
  return out;
}

fractal::CellMeanLaw::Values law(double dimension) {
  return fractal::CellMeanLaw::instance().at(static_cast<float>(3.0 - dimension));
}

/// limit / true change over a cell, of every cell.
std::vector<float> ratios(const GroundLayers& ground, double dimension) {
  SerialExecutor serial;
  BendLimit limit;
  limit.update(ground, serial);
  const double change_m = kAmplitude_m * std::pow(kCell_m, 3.0 - dimension);
  std::vector<float> out;
  for (int row = 0; row < kSide; ++row)
    for (int column = 0; column < kSide; ++column)
      out.push_back(limit.change_m(row, column, law(dimension)) / static_cast<float>(change_m));
  std::sort(out.begin(), out.end());
  return out;
}

// The log of the limit errs by .85/√50 or so at each lag, and by half as much again because neighbours share bends:
// .18. Its median is that of some 60 windows apart, ± .03, of the lesser of two, − .56·.18 at most; each lag's own
// formula is of means over cells and within .05 (fractal/cell_mean_law.hpp): 2·[e^−.18, e^.08]. Below the truth is 3.8
// deviations off for one and hardly for two: 1 % are let pass.
TEST(BendLimit, IsTwiceTheChangeOfTheGroundsOwnLaw) {
  for (const double dimension : {2.2, 2.5, 2.8}) {
    const Grid<float> fine = points(dimension);
    for (const int places : {1, 4}) {
      const auto sorted = ratios(test::ground_of(cells(fine, places), static_cast<std::uint16_t>(places)), dimension);
      EXPECT_GT(sorted[sorted.size() / 2], 1.67F) << dimension << ' ' << places;
      EXPECT_LT(sorted[sorted.size() / 2], 2.17F) << dimension << ' ' << places;
      EXPECT_GT(sorted[sorted.size() / 100], 1.0F) << dimension << ' ' << places;
    }
  }
}

// Boulders on a twentieth of the cells of smooth ground. Their rms change over a cell is √(2·.05·.95)·h = .31 h, their
// own D near 3; a limit below that would make the field look smooth. By the mean root of the bends (a twentieth of 2 h,
// a tenth of h, the rest of the ground) it should be .35 h.
TEST(BendLimit, HearsOfBouldersOnATwentiethOfTheCells) {
  constexpr float kBoulder_m = 0.25F;
  Grid<float> field(kSide, kSide);
  for (int row = 0; row < kSide; ++row)
    for (int column = 0; column < kSide; ++column)
      field(row, column) = 0.01F * static_cast<float>(random_normals(5, 0, column, row)[0]) +
                           (to_uniform(random_words(5, 1, column, row)[0]) < 0.05 ? kBoulder_m : 0.0F);
  SerialExecutor serial;
  BendLimit limit;
  limit.update(test::ground_of(field, 100), serial);
  std::vector<float> limits;
  for (int row = 0; row < kSide; ++row)
    for (int column = 0; column < kSide; ++column) limits.push_back(limit.change_m(row, column, law(2.9)));
  std::nth_element(limits.begin(), limits.begin() + kSide * kSide / 2, limits.end());
  EXPECT_GT(limits[kSide * kSide / 2], 0.31F * kBoulder_m);
}

TEST(BendLimit, TakesTheNoiseOfTheHeightsOff) {
  Grid<float> flat(kSide, kSide);
  constexpr float kNoise_m = 0.02F;
  for (int row = 0; row < kSide; ++row)
    for (int column = 0; column < kSide; ++column)
      flat(row, column) = kNoise_m * static_cast<float>(random_normals(5, 0, column, row)[0]);
  const float told = ratios(test::ground_of(flat, 4, kNoise_m * kNoise_m), 2.5)[kSide * kSide / 2];
  const float untold = ratios(test::ground_of(flat, 4), 2.5)[kSide * kSide / 2];
  // down to what chance may hide: √(1.7/√50) = .49, or √(1.7/√578) = .27 at the far lag
  EXPECT_LT(told, 0.6F * untold);
  EXPECT_GT(told, 0.2F * untold);
}

TEST(BendLimit, JudgesSparseCellsByFarBends) {
  const Grid<float> all = cells(points(2.5), 4);
  Grid<float> sparse(kSide, kSide, NAN);
  for (int row = 0; row < kSide; row += 4)
    for (int column = 0; column < kSide; column += 4) sparse(row, column) = all(row, column);
  const auto sorted = ratios(test::ground_of(sparse, 4), 2.5);
  // some 40 bends of cells four apart: ± .14 in the log; the median of some 25 windows apart: ± .04, and .05 as above
  EXPECT_NEAR(std::log(sorted[sorted.size() / 2] / 2.0F), 0.0F, 0.17F);  // three deviations and the formula's
}

TEST(BendLimit, GoesByTheWholeMapWhereTooFewAreNearAndIsNoneWhereAllAreTooFew) {
  const Grid<float> all = cells(points(2.5), 4);
  Grid<float> corner(kSide, kSide, NAN);
  for (int row = 0; row < 20; ++row)
    for (int column = 0; column < 20; ++column) corner(row, column) = all(row, column);
  SerialExecutor serial;
  BendLimit limit;
  limit.update(test::ground_of(corner, 4), serial);
  const float far_m = limit.change_m(70, 70, law(2.5));
  EXPECT_NEAR(far_m / (kAmplitude_m * std::sqrt(kCell_m)), 2.0, 0.6);  // 760 bends that are shared: ± .1 in the log
  limit.update(test::ground_of(Grid<float>(kSide, kSide, NAN)), serial);
  EXPECT_TRUE(std::isinf(limit.change_m(70, 70, law(2.5))));
}

}  // namespace
}  // namespace scree::mapping
