#include "fractal/reconstruction/cell_samples.hpp"

#include <cmath>
#include <gtest/gtest.h>

#include "core/random.hpp"

namespace scree::fractal {
namespace {

const SurfaceGrid kGrid{3, 4, 0.5};
const LawMap kLaw{{2.4, 0.2}, {}, {}};

TEST(CellSamples, ASampleAtTheCentreKeepsItsHeightAndItsVariance) {
  const HeightSamples one{{0.75}, {1.25}, {3.5}, {0.01}};
  const CellSamples cells = bin_samples(one, kGrid, kLaw);
  EXPECT_EQ(cells.cells, 1u);
  EXPECT_FLOAT_EQ(cells.height_m(2, 1), 3.5F);
  EXPECT_FLOAT_EQ(cells.variance_m2(2, 1), 0.01F);
  EXPECT_EQ(cells.hits(2, 1), 1);
  EXPECT_TRUE(std::isnan(cells.height_m(0, 0)));
}

TEST(CellSamples, ASampleBesideTheCentreCarriesTheGroundInBetween) {
  const HeightSamples one{{0.95}, {1.25}, {3.5}, {0.01}};
  const double change = kLaw.law.rms_change_m(0.2);
  EXPECT_NEAR(bin_samples(one, kGrid, kLaw).variance_m2(2, 1), 0.01 + change * change, 1e-8);
}

TEST(CellSamples, TwoSamplesAtOnePlaceShareItsGround) {
  const HeightSamples two{{0.95, 0.95}, {1.25, 1.25}, {3.0, 4.0}, {0.01, 0.01}};
  const CellSamples cells = bin_samples(two, kGrid, kLaw);
  const double change = kLaw.law.rms_change_m(0.2);
  EXPECT_FLOAT_EQ(cells.height_m(2, 1), 3.5F);
  EXPECT_NEAR(cells.variance_m2(2, 1), 0.005 + change * change, 1e-8);
}

TEST(CellSamples, OutsideIsCountedAndEdgesBelongToTheCellAbove) {
  const HeightSamples samples{{-0.01, 2.0, 0.5, 1.0}, {0.1, 0.1, 0.0, 1.5}, {1, 1, 1, 1}, {0, 0, 0, 0}};
  const CellSamples cells = bin_samples(samples, kGrid, kLaw);
  EXPECT_EQ(cells.outside, 3u);
  EXPECT_EQ(cells.inside, 1u);
  EXPECT_EQ(cells.hits(0, 1), 1);
}

/// Five points of a cell on 4000 exact surfaces of a fine lattice: the squared error of the centre over its variance
/// has mean 1; its standard error is √(2/4000) = .022, 4.5 of them allow one false alarm in 150,000.
TEST(CellSamples, TheVarianceIsThatOfTheError) {
  constexpr int kFine = 9;  // lattice values across the cell, the centre is one of them
  const double pitch = 0.5 / kFine;
  const int at[5][2] = {{0, 3}, {2, 8}, {5, 5}, {7, 0}, {8, 7}};
  double ratio = 0.0;
  constexpr int kSurfaces = 4000;
  for (int s = 0; s < kSurfaces; ++s) {
    const auto fine = fbm_surface(kLaw.law, kFine, kFine, pitch, static_cast<std::uint64_t>(s));
    ASSERT_TRUE(fine);
    HeightSamples samples;
    for (int k = 0; k < 5; ++k) {
      const double sigma = 0.02 * (k + 1);
      samples.x_m.push_back((at[k][1] + 0.5) * pitch);
      samples.y_m.push_back((at[k][0] + 0.5) * pitch);
      samples.z_m.push_back((*fine)(at[k][0], at[k][1]) + sigma * random_normals(9, 1, s, k)[0]);
      samples.variance_m2.push_back(sigma * sigma);
    }
    const CellSamples cells = bin_samples(samples, {1, 1, 0.5}, kLaw);
    const double error = cells.height_m(0, 0) - (*fine)(kFine / 2, kFine / 2);
    ratio += error * error / cells.variance_m2(0, 0) / kSurfaces;
  }
  EXPECT_NEAR(ratio, 1.0, 4.5 * std::sqrt(2.0 / kSurfaces));
}

}  // namespace
}  // namespace scree::fractal
