#include "fractal/surface.hpp"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <vector>

#include "fractal/fbm_embedding.hpp"
#include "fractal/fourier.hpp"

namespace scree::fractal {
namespace {

TEST(Dft, AgreesWithTheDefinition) {
  constexpr int kLength = 30;  // radices 2, 3 and 5
  std::vector<std::complex<double>> in(kLength), out(kLength);
  for (int j = 0; j < kLength; ++j) in[static_cast<std::size_t>(j)] = {std::sin(3.0 * j), 1.0 / (j + 1)};
  Dft<double> dft(kLength);
  dft.forward(in.data(), out.data());
  for (int k = 0; k < kLength; ++k) {
    std::complex<double> sum;
    for (int j = 0; j < kLength; ++j)
      sum += in[static_cast<std::size_t>(j)] * std::polar(1.0, -2.0 * std::numbers::pi * j * k / kLength);
    EXPECT_LT(std::abs(sum - out[static_cast<std::size_t>(k)]), 1e-13 * kLength);
  }
}

TEST(Dft, SmoothSizesAreEvenAndHaveNoPrimeAboveFive) {
  EXPECT_EQ(smooth_even_size(1), 2);
  EXPECT_EQ(smooth_even_size(7), 8);
  EXPECT_EQ(smooth_even_size(3394), 3456);
  EXPECT_EQ(smooth_even_size(1442), 1458);
}

TEST(FbmEmbedding, HasNoNegativeEigenvalueBeyondRounding) {
  for (int i = 1; i <= 19; ++i) {
    const double hurst = 0.05 * i;
    const FbmEmbedding embedding = make_embedding(hurst, embedding_side(hurst, 90.0));
    const auto [smallest, largest] = std::minmax_element(embedding.eigenvalues.begin(), embedding.eigenvalues.end());
    EXPECT_GE(*smallest, -1e-10 * *largest) << "H = " << hurst;
  }
}

// The eigenvalues sum to M² ρ(0), and their transform at a lag is M² ρ(lag): the law itself, with no randomness.
TEST(FbmEmbedding, CovarianceIsThePowerLawWithinTheUnit) {
  for (const double hurst : {0.1, 0.5, 0.75, 0.76, 0.9}) {
    const FbmEmbedding embedding = make_embedding(hurst, 96);
    const int half = embedding.side / 2;
    const auto covariance = [&](int lag_x, int lag_y) {
      double sum = 0.0;
      for (int v = 0; v < embedding.side; ++v)
        for (int u = 0; u < embedding.side; ++u) {
          const int fu = std::min(u, embedding.side - u), fv = std::min(v, embedding.side - v);
          sum += embedding.eigenvalues[static_cast<std::size_t>(fv * (half + 1) + fu)] *
                 std::cos(2.0 * std::numbers::pi * (u * lag_x + v * lag_y) / embedding.side);
        }
      return sum / (embedding.side * embedding.side);
    };
    const double scale = std::pow(embedding.unit_cells, 2.0 * hurst) / 2.0;
    const double slope2 = embedding.plane_slope_sigma() * embedding.plane_slope_sigma();
    for (const auto& [x, y] : {std::pair{1, 0}, {3, 4}, {10, 0}, {0, 20}, {14, 14}}) {
      const double r2 = x * x + y * y;
      const double gamma = 2.0 * scale * (covariance(0, 0) - covariance(x, y)) + slope2 * r2;
      EXPECT_NEAR(gamma / std::pow(r2, hurst), 1.0, 1e-9) << "H = " << hurst << " lag " << x << "," << y;
    }
  }
}

/// Mean squared change over `lag` cells along both axes.
double structure(const Grid<float>& z, int lag) {
  double sum = 0.0;
  int pairs = 0;
  for (int r = 0; r < z.rows(); ++r)
    for (int c = 0; c < z.columns(); ++c) {
      if (c + lag < z.columns()) sum += std::pow(z(r, c + lag) - z(r, c), 2), ++pairs;
      if (r + lag < z.rows()) sum += std::pow(z(r + lag, c) - z(r, c), 2), ++pairs;
    }
  return sum / pairs;
}

// n = 60 surfaces for each of 5 H, 5 lags; the standard error is the surfaces' own (t with 59 degrees of freedom).
// Bound 4 s.e.: false-alarm rate 25 · 1.8e-4 = 0.5 %, and the seeds are fixed.
TEST(FbmSurface, EnsembleStructureFunctionIsThePowerLaw) {
  constexpr int kSurfaces = 60, kSide = 65;
  const std::vector<int> lags = {1, 2, 4, 8, 16};
  for (const double dimension : {2.1, 2.3, 2.5, 2.7, 2.9}) {
    const FractalLaw law{dimension, 0.2};
    std::vector<double> sum(lags.size()), sum2(lags.size());
    for (int i = 0; i < kSurfaces; ++i) {
      const auto z = fbm_surface(law, kSide, kSide, 0.1, 1000 + static_cast<std::uint64_t>(i));
      ASSERT_TRUE(z);
      for (std::size_t k = 0; k < lags.size(); ++k) {
        const double ratio = structure(*z, lags[k]) / std::pow(law.rms_change_m(0.1 * lags[k]), 2);
        sum[k] += ratio;
        sum2[k] += ratio * ratio;
      }
    }
    for (std::size_t k = 0; k < lags.size(); ++k) {
      const double mean = sum[k] / kSurfaces;
      const double error = std::sqrt((sum2[k] / kSurfaces - mean * mean) / (kSurfaces - 1));
      EXPECT_LT(std::abs(mean - 1.0), 4.0 * error) << "D = " << dimension << " lag " << lags[k] << " mean " << mean;
    }
  }
}

// n = 60 surfaces for each of 3 D, 2 lags; 4 s.e. of the surfaces' own spread: false-alarm rate 6 · 1.8e-4.
TEST(FbmSurface, BendIsTheRmsSecondDifference) {
  constexpr int kSurfaces = 60, kSide = 65;
  for (const double dimension : {2.1, 2.5, 2.9})
    for (const int lag : {1, 5}) {
      const FractalLaw law{dimension, 0.2};
      double sum = 0.0, sum2 = 0.0;
      for (int i = 0; i < kSurfaces; ++i) {
        const auto z = fbm_surface(law, kSide, kSide, 0.1, 5000 + static_cast<std::uint64_t>(i));
        ASSERT_TRUE(z);
        double energy = 0.0;
        for (int r = 0; r < kSide; ++r)
          for (int c = lag; c + lag < kSide; ++c)
            energy += std::pow((*z)(r, c + lag) - 2.0F * (*z)(r, c) + (*z)(r, c - lag), 2);
        const double ratio = energy / (kSide * (kSide - 2 * lag)) / std::pow(law.rms_bend_m(0.1 * lag), 2);
        sum += ratio;
        sum2 += ratio * ratio;
      }
      const double mean = sum / kSurfaces;
      const double error = std::sqrt((sum2 / kSurfaces - mean * mean) / (kSurfaces - 1));
      EXPECT_LT(std::abs(mean - 1.0), 4.0 * error) << "D = " << dimension << " lag " << lag << " mean " << mean;
    }
}

// The rms change at 1 m is amplitude_m whatever the cell; n = 80 surfaces a cell size, 4 s.e. of each, false-alarm
// rate 3 · 1.5e-4.
TEST(FbmSurface, AmplitudeIsTheRmsChangeAtOneMetre) {
  for (const double cell_m : {0.05, 0.1, 0.25}) {
    constexpr int kSurfaces = 80;
    const int lag = static_cast<int>(std::lround(1.0 / cell_m));
    double sum = 0.0, sum2 = 0.0;
    for (int i = 0; i < kSurfaces; ++i) {
      const auto z = fbm_surface({2.4, 0.3}, 4 * lag, 4 * lag, cell_m, static_cast<std::uint64_t>(i));
      ASSERT_TRUE(z);
      const double value = structure(*z, lag);
      sum += value;
      sum2 += value * value;
    }
    const double mean = sum / kSurfaces;
    const double error = std::sqrt((sum2 / kSurfaces - mean * mean) / (kSurfaces - 1));
    EXPECT_NEAR(mean, 0.09, 4.0 * error) << "cell " << cell_m;
  }
}

TEST(FbmSurface, IsReproducibleFromItsSeedAndZeroAtTheOrigin) {
  const auto a = fbm_surface({2.2, 0.1}, 40, 57, 0.1, 5), b = fbm_surface({2.2, 0.1}, 40, 57, 0.1, 5);
  const auto c = fbm_surface({2.2, 0.1}, 40, 57, 0.1, 6);
  ASSERT_TRUE(a && b && c);
  EXPECT_EQ(*a, *b);
  EXPECT_NE(*a, *c);
  EXPECT_EQ((*a)(0, 0), 0.0F);
}

TEST(FbmSurface, RefusesWhatItCannotMake) {
  EXPECT_EQ(fbm_surface({2.0, 0.1}, 10, 10, 0.1, 1).error().kind, ErrorKind::usage);
  EXPECT_NE(fbm_surface({3.1, 0.1}, 10, 10, 0.1, 1).error().message.find("3.1"), std::string::npos);
  EXPECT_FALSE(fbm_surface({2.5, -1.0}, 10, 10, 0.1, 1));
  EXPECT_FALSE(fbm_surface({2.5, 0.1}, 0, 10, 0.1, 1));
  EXPECT_FALSE(fbm_surface({2.5, 0.1}, 10, 10, 0.0, 1));
  EXPECT_FALSE(fbm_surface({2.1, 0.1}, 10, 100000, 0.1, 1));
  EXPECT_TRUE(fbm_surface({2.5, 0.1}, 1, 1, 0.1, 1));
}

}  // namespace
}  // namespace scree::fractal
