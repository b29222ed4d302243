#include "fractal/cell_mean_law.hpp"

#include <cmath>
#include <gtest/gtest.h>

#include "fractal/support.hpp"
#include "fractal/surface.hpp"

namespace scree::fractal {
namespace {

TEST(CellMeanLaw, AgreesWithCellsOverOneAndSixAndNearlyBetween) {
  for (const double hurst : {0.2, 0.35, 0.5, 0.7, 0.9}) {
    const CellMeanLaw::Values law = CellMeanLaw::exact(hurst);
    for (const int lag : {1, 2, 3, 4, 6, 16}) {
      const double truth =
          std::sqrt(mean_variogram(Support::block, hurst, lag, 0) - mean_variogram(Support::block, hurst, 0, 0));
      const double said = static_cast<double>(law.change) * std::pow(lag, static_cast<double>(law.hurst));
      const double allowed = lag == 1 || lag == 6 ? 1e-5 : lag == 16 ? 0.2 : 0.08;
      EXPECT_NEAR(said / truth, 1.0, allowed) << hurst << ' ' << lag;
    }
  }
}

TEST(CellMeanLaw, TableHoldsItToTwoThousandths) {
  for (double hurst = 0.06; hurst < 0.95; hurst += 0.0171) {
    const auto table = CellMeanLaw::instance().at(static_cast<float>(hurst)), exact = CellMeanLaw::exact(hurst);
    EXPECT_NEAR(table.hurst, exact.hurst, 2e-3F) << hurst;
    EXPECT_NEAR(table.change, exact.change, 2e-3F) << hurst;
    EXPECT_NEAR(table.within, exact.within, 2e-3F) << hurst;
  }
}

// Means of 10 × 10 points of an exact surface, 60 × 60 cells: the mean square change over one cell has a relative
// standard error of about 3 %; the lattice of points adds 1 % at H = .3.
TEST(CellMeanLaw, IsWhatMeansOfASurfaceShow) {
  const int cells = 60, points = 10;
  const Grid<float> fine = *fbm_surface({2.7, 1.0}, cells * points, cells * points, 0.1, 3);
  Grid<double> mean(cells, cells, 0.0);
  double within = 0.0;
  for (int r = 0; r < cells; ++r)
    for (int c = 0; c < cells; ++c) {
      double sum = 0.0, square = 0.0;
      for (int y = 0; y < points; ++y)
        for (int x = 0; x < points; ++x) {
          const double z = static_cast<double>(fine(r * points + y, c * points + x));
          sum += z;
          square += z * z;
        }
      mean(r, c) = sum / 100.0;
      within += square / 100.0 - mean(r, c) * mean(r, c);
    }
  double change2 = 0.0;
  for (int r = 0; r < cells; ++r)
    for (int c = 1; c < cells; ++c) change2 += std::pow(mean(r, c) - mean(r, c - 1), 2);
  const CellMeanLaw::Values law = CellMeanLaw::exact(0.3);  // a cell is 1 m: C = 1
  EXPECT_NEAR(std::sqrt(change2 / (cells * (cells - 1))) / static_cast<double>(law.change), 1.0, 0.05);
  EXPECT_NEAR(within / (cells * cells) / static_cast<double>(law.within), 1.0, 0.05);
}

}  // namespace
}  // namespace scree::fractal
