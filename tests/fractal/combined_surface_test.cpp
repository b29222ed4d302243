#include "fractal/combined_surface.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <vector>

#include "fractal/profile_pair.hpp"

namespace scree::fractal {
namespace {

constexpr double kQuarter = 0.5 * std::numbers::pi;

/// Mean products over `count` independent pairs of profiles.
struct Moments {
  double first = 0.0, second = 0.0, both = 0.0;
  Moments(double h1, double h2, double rho, int from, int to, int count) {
    for (int seed = 0; seed < count; ++seed) {
      const auto pair = *fbm_profile_pair(h1, h2, rho, 64, static_cast<std::uint64_t>(seed));
      const auto change = [&](const std::vector<double>& f) {
        return f[static_cast<std::size_t>(to)] - f[static_cast<std::size_t>(from)];
      };
      first += change(pair.first) * change(pair.first) / count;
      second += change(pair.second) * change(pair.second) / count;
      both += change(pair.first) * change(pair.second) / count;
    }
  }
};

// n = 4000 independent pairs: a variance has the relative standard error √(2/n) = 2.2 %, the correlation
// (1 − ρ²)/√n = .6 %; 24 comparisons at 4.5 s.e.: false-alarm rate 2e-4 in all.
TEST(ProfilePair, BothAreFractionalBrownianAndCorrelatedOverEveryInterval) {
  for (const auto& [h1, h2] : {std::pair{0.3, 0.6}, {0.4, 0.8}, {0.5, 0.5}})
    for (const auto& [from, to] : {std::pair{0, 1}, {20, 24}, {3, 63}}) {
      const Moments m(h1, h2, 0.8, from, to, 4000);
      const double length = to - from;
      EXPECT_NEAR(m.first / std::pow(length, 2 * h1), 1.0, 0.1);
      EXPECT_NEAR(m.second / std::pow(length, 2 * h2), 1.0, 0.1);
      EXPECT_NEAR(m.both / std::sqrt(m.first * m.second), 0.8, 0.026);
    }
}

TEST(ProfilePair, CorrelationHasABound) {
  EXPECT_DOUBLE_EQ(max_profile_correlation(0.4, 0.4), 1.0);
  EXPECT_NEAR(max_profile_correlation(0.4, 0.4 + 1e-9), 1.0, 1e-6);
  EXPECT_GT(max_profile_correlation(0.4, 0.8), 0.8);  // the fourth terrain of the paper just exists
  EXPECT_TRUE(fbm_profile_pair(0.4, 0.8, 0.8, 1024, 1));
  EXPECT_TRUE(fbm_profile_pair(0.6, 0.6, -1.0, 1024, 1));
  for (const int count : {100, 5000}) {  // the embedding needs a little less
    const double limit = max_profile_correlation(0.2, 0.9);
    EXPECT_TRUE(fbm_profile_pair(0.2, 0.9, 0.97 * limit, count, 1));
    const auto refused = fbm_profile_pair(0.2, 0.9, 1.001 * limit, count, 1);
    ASSERT_FALSE(refused);
    EXPECT_TRUE(refused.error().message.starts_with("fBm profiles: expected a correlation of at most 0.49"));
  }
}

// Conclusion 1 of [X09] eq. 16, exactly.
TEST(CombinedLaw, HasHxAlongXAndHyAlongY) {
  for (const double rho : {-0.5, 0.0, 0.8})
    for (const double lag : {0.1, 1.0, 30.0}) {
      const CombinedLaw law{0.3, 0.6, 0.4, rho, 0.2};
      EXPECT_NEAR(combined_hurst(law, 0.0, lag), 0.3, 1e-6);  // sin 0 = 0, cos 90° = 6e-17
      EXPECT_NEAR(combined_hurst(law, kQuarter, lag), 0.6, 1e-6);
    }
}

// Conclusion 2: one H stays that H, whatever the weight, the correlation, the direction.
TEST(CombinedLaw, OfOneHIsThatH) {
  for (const double rho : {-0.9, 0.0, 0.8})
    for (const double weight : {0.1, 0.5, 0.8})
      for (double azimuth = 0.0; azimuth <= kQuarter; azimuth += 0.1)
        EXPECT_NEAR(combined_hurst({0.45, 0.45, weight, rho, 1.0}, azimuth, 3.0), 0.45, 1e-12);
}

// Conclusion 3: without correlation H = H_x + B(H_y − H_x)/(A + B), A and B as eq. 13 has them.
TEST(CombinedLaw, WithoutCorrelationIsTheSumOfTwo) {
  const CombinedLaw law{0.4, 0.8, 0.3, 0.0, 1.0};
  for (double azimuth = 0.05; azimuth < kQuarter; azimuth += 0.1) {
    const double a = 0.09 * std::pow(2.0 * std::cos(azimuth), 0.8), b = 0.49 * std::pow(2.0 * std::sin(azimuth), 1.6);
    EXPECT_NEAR(combined_hurst(law, azimuth, 2.0), 0.4 + b * 0.4 / (a + b), 1e-12);
    EXPECT_NEAR(combined_squared_change(law, azimuth, 2.0), a + b, 1e-12);
  }
}

TEST(CombinedLaw, HurstIsTheLogarithmicSlope) {
  const CombinedLaw law{0.3, 0.6, 0.5, 0.8, 0.7};
  for (double azimuth = 0.05; azimuth < kQuarter; azimuth += 0.2)
    for (const double lag : {0.5, 4.0}) {
      const double above = std::log(combined_squared_change(law, azimuth, lag * 1.001)),
                   below = std::log(combined_squared_change(law, azimuth, lag / 1.001));
      EXPECT_NEAR(combined_hurst(law, azimuth, lag), 0.5 * (above - below) / (2.0 * std::log(1.001)), 1e-6);
    }
}

// At 45° the covariance is the paper's: ρσ²·Δx^H_x·Δy^H_y.
TEST(CombinedLaw, OnTheDiagonalIsThePapersEquation13) {
  const double x = 2.0 * std::sqrt(0.5);
  EXPECT_NEAR(combined_squared_change({0.3, 0.6, 0.4, 0.7, 1.0}, std::numbers::pi / 4, 2.0),
              0.16 * std::pow(x, 0.6) + 0.36 * std::pow(x, 1.2) + 2 * 0.24 * 0.7 * std::pow(x, 0.9), 1e-12);
}

// The surfaces themselves. n = 3000 independent ones, increments from the point (8, 8) of the diagonal by 4 and 16
// cells along 0°, 90° and 45° (x and y both): squared changes have the relative standard error √(2/n) = 2.6 %, H
// between them .026·√2/(2 ln 4) = .013 at most; 12 comparisons at 4.5 s.e.: false-alarm rate 8e-5 in all.
TEST(CombinedSurface, HasTheLawOfEquation16) {
  constexpr int kCount = 3000;
  const CombinedLaw law{0.3, 0.6, 0.5, 0.8, 0.2};
  struct Direction {
    int x, y;
    double azimuth;
  };
  for (const Direction& direction :
       {Direction{1, 0, 0.0}, {0, 1, kQuarter}, {1, 1, std::numbers::pi / 4}, {1, 2, std::atan(2.0)}}) {
    const int x = direction.x, y = direction.y;
    const double azimuth = direction.azimuth;
    double near = 0.0, far = 0.0;
    for (int seed = 0; seed < kCount; ++seed) {
      const Grid<float> z = *combined_surface(law, 48, 32, 0.5, static_cast<std::uint64_t>(seed));
      const auto squared = [&](int cells) {
        return std::pow(static_cast<double>(z(8 + cells * y, 8 + cells * x) - z(8, 8)), 2) / kCount;
      };
      near += squared(4);
      far += squared(16);
    }
    const double unit = 0.5 * std::hypot(x, y);
    EXPECT_NEAR(near / combined_squared_change(law, azimuth, 4 * unit), 1.0, 0.12);
    EXPECT_NEAR(far / combined_squared_change(law, azimuth, 16 * unit), 1.0, 0.12);
    const double slope =
        0.5 *
        std::log(combined_squared_change(law, azimuth, 16 * unit) / combined_squared_change(law, azimuth, 4 * unit)) /
        std::log(4.0);
    EXPECT_NEAR(0.5 * std::log(far / near) / std::log(4.0), slope, 0.06);
  }
}

TEST(CombinedSurface, IsRepeatableAndSaysWhatIsWrong) {
  const CombinedLaw law{0.3, 0.6, 0.5, 0.5, 0.1};
  EXPECT_EQ(*combined_surface(law, 20, 30, 0.1, 4), *combined_surface(law, 20, 30, 0.1, 4));
  EXPECT_NE(*combined_surface(law, 20, 30, 0.1, 4), *combined_surface(law, 20, 30, 0.1, 5));
  EXPECT_EQ((*combined_surface(law, 20, 30, 0.1, 4))(0, 0), 0.0F);
  const auto message = [](const CombinedLaw& bad, int size = 20, double cell = 0.1) {
    const auto surface = combined_surface(bad, size, size, cell, 1);
    EXPECT_FALSE(surface);
    EXPECT_EQ(surface.error().kind, ErrorKind::usage);
    return surface.error().message;
  };
  EXPECT_EQ(message(law, 1), "combined surface: expected at least 2 x 2 cells, found 1 x 1");
  EXPECT_EQ(message(law, 9, 0.0), "combined surface: expected a finite cell_m > 0, found 0");
  EXPECT_EQ(message({1.0, 0.6, 0.5, 0.0, 0.1}), "fBm profiles: expected 0 < H < 1, found H = 1");
  EXPECT_EQ(message({0.3, 0.6, 1.5, 0.0, 0.1}), "combined surface: expected 0 <= weight <= 1, found 1.5");
  EXPECT_EQ(message({0.3, 0.6, 0.5, 0.0, -1.0}), "combined surface: expected a finite amplitude_m > 0, found -1");
}

}  // namespace
}  // namespace scree::fractal
