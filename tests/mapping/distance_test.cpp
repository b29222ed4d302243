#include "mapping/distance.hpp"

#include <gtest/gtest.h>
#include <limits>

#include "core/random.hpp"
#include "tests/mapping/support.hpp"

namespace scree::mapping {
namespace {

Grid<std::uint8_t> scattered(int rows, int columns, double density, std::uint64_t seed) {
  Grid<std::uint8_t> set(rows, columns, 0);
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column)
      set(row, column) = to_uniform(random_words(seed, 0, column, row)[0]) < density ? 1 : 0;
  return set;
}

float brute_force(const Grid<std::uint8_t>& set, int row, int column, int limit) {
  float best = std::numeric_limits<float>::infinity();
  for (int y = 0; y < set.rows(); ++y)
    for (int x = 0; x < set.columns(); ++x) {
      const int d2 = (x - column) * (x - column) + (y - row) * (y - row);
      if (set(y, x) != 0 && d2 <= limit * limit) best = std::min(best, static_cast<float>(d2));
    }
  return best;
}

TEST(BoundedDistance, EqualsBruteForce) {
  test::ReversedRanges executor(3);
  for (const int limit : {0, 1, 4, 9}) {
    const auto set = scattered(23, 31, 0.02, static_cast<std::uint64_t>(limit));
    BoundedDistance distance;
    Grid<float> squared;
    distance.transform(set, limit, executor, squared);
    for (int row = 0; row < set.rows(); ++row)
      for (int column = 0; column < set.columns(); ++column)
        ASSERT_EQ(squared(row, column), brute_force(set, row, column, limit)) << row << ' ' << column;
  }
}

TEST(Closing, FillsTheGapBetweenRowsAndDoesNotGrowOutwards) {
  SerialExecutor serial;
  Grid<std::uint8_t> set(40, 40, 0);
  for (int column = 0; column < 40; ++column)
    for (const int row : {10, 20}) set(row, column) = 1;
  Grid<std::uint8_t> closed;
  Closing closing;
  closing.close(set, 6.0, serial, closed);
  for (int row = 10; row <= 20; ++row) EXPECT_EQ(closed(row, 20), 1) << row;
  EXPECT_EQ(closed(9, 20), 0);
  EXPECT_EQ(closed(21, 20), 0);
  closing.close(set, 4.0, serial, closed);  // the gap is wider than twice the reach
  for (int row = 11; row < 20; ++row) EXPECT_EQ(closed(row, 20), 0) << row;
}

TEST(Closing, NeverReachesFartherThanTheReach) {
  SerialExecutor serial;
  const auto set = scattered(50, 50, 0.01, 9);
  Grid<std::uint8_t> closed;
  Closing closing;
  closing.close(set, 5.5, serial, closed);
  for (int row = 0; row < 50; ++row)
    for (int column = 0; column < 50; ++column)
      if (closed(row, column) != 0) {
        EXPECT_LE(brute_force(set, row, column, 50), 5.5F * 5.5F);
      }
}

}  // namespace
}  // namespace scree::mapping
