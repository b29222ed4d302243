#include "core/random.hpp"

#include <cmath>
#include <gtest/gtest.h>

namespace scree {
namespace {

// Known answers distributed with the authors' reference implementation (kat_vectors, philox4x32-10).
TEST(Philox, AgreesWithPublishedKnownAnswers) {
  EXPECT_EQ(philox4x32({0, 0, 0, 0}, {0, 0}),
            (std::array<std::uint32_t, 4>{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}));
  EXPECT_EQ(philox4x32({0xffffffff, 0xffffffff, 0xffffffff, 0xffffffff}, {0xffffffff, 0xffffffff}),
            (std::array<std::uint32_t, 4>{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}));
  EXPECT_EQ(philox4x32({0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}, {0xa4093822, 0x299f31d0}),
            (std::array<std::uint32_t, 4>{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}));
}

// n = 80,000 normals: the mean has standard error 1/√n, the variance √(2/n), neighbours' correlation 1/√n;
// bounds at 5 standard errors, false-alarm rate 3 · 6e-7.
TEST(RandomNormals, AreStandardAndIndependentOnTheLattice) {
  constexpr int kSide = 200;
  double sum = 0.0, sum2 = 0.0, lagged = 0.0;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      const auto here = random_normals(7, 3, x, y);
      const auto right = random_normals(7, 3, x + 1, y);
      sum += here[0] + here[1];
      sum2 += here[0] * here[0] + here[1] * here[1];
      lagged += here[0] * right[0] + here[1] * right[1];
    }
  const double n = 2.0 * kSide * kSide;
  EXPECT_LT(std::abs(sum / n), 5.0 / std::sqrt(n));
  EXPECT_LT(std::abs(sum2 / n - 1.0), 5.0 * std::sqrt(2.0 / n));
  EXPECT_LT(std::abs(lagged / n), 5.0 / std::sqrt(n));
}

TEST(RandomNormals, DependOnSeedStreamAndPlaceOnly) {
  EXPECT_EQ(random_normals(1, 2, -3, 4), random_normals(1, 2, -3, 4));
  EXPECT_NE(random_normals(1, 2, -3, 4), random_normals(2, 2, -3, 4));
  EXPECT_NE(random_normals(1, 2, -3, 4), random_normals(1, 3, -3, 4));
  EXPECT_NE(random_normals(1, 2, -3, 4), random_normals(1, 2, 4, -3));
}

}  // namespace
}  // namespace scree
