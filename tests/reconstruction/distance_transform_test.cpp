#include "fractal/reconstruction/distance_transform.hpp"

#include <algorithm>
#include <gtest/gtest.h>

#include "core/random.hpp"

namespace scree::fractal {
namespace {

Grid<std::uint8_t> scattered(int rows, int columns, double density, std::uint64_t seed) {
  Grid<std::uint8_t> set(rows, columns, 0);
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c) set(r, c) = to_uniform(random_words(seed, 1, c, r)[0]) < density ? 1 : 0;
  return set;
}

std::int32_t nearest(const Grid<std::uint8_t>& set, int row, int column) {
  std::int32_t best = DistanceTransform::kNone;
  for (int r = 0; r < set.rows(); ++r)
    for (int c = 0; c < set.columns(); ++c)
      if (set(r, c) != 0) best = std::min(best, (r - row) * (r - row) + (c - column) * (c - column));
  return best;
}

// Densities from everything set to a single cell: offsets alone, the envelope alone, and columns without a set cell.
TEST(DistanceTransform, IsTheNearestSetCell) {
  DistanceTransform transform;
  SerialExecutor serial;
  Grid<std::int32_t> squared;
  for (const double density : {1.0, 0.3, 0.05, 0.002, 0.0004})
    for (const auto& [rows, columns] : {std::pair{90, 130}, {1, 200}, {200, 1}, {37, 41}}) {
      Grid<std::uint8_t> set = scattered(rows, columns, density, 3);
      set(rows - 1, columns / 3) = 1;
      transform.transform(set, serial, squared);
      for (int r = 0; r < rows; r += 1 + rows / 23)
        for (int c = 0; c < columns; c += 1 + columns / 29)
          ASSERT_EQ(squared(r, c), nearest(set, r, c)) << density << ' ' << r << ' ' << c;
    }
}

TEST(DistanceTransform, NothingSetIsNowhereNear) {
  DistanceTransform transform;
  SerialExecutor serial;
  Grid<std::int32_t> squared;
  transform.transform(Grid<std::uint8_t>(5, 100, 0), serial, squared);
  EXPECT_TRUE(std::all_of(squared.begin(), squared.end(), [](auto d) { return d == DistanceTransform::kNone; }));
  transform.transform({}, serial, squared);
  EXPECT_TRUE(squared.empty());
}

TEST(DistanceTransform, DoesNotDependOnHowTheWorkIsCut) {
  class Pieces final : public Executor {
    void for_ranges(int count, const std::function<void(int, int)>& body) override {
      for (int i = count; i > 0; i -= 7) body(std::max(i - 7, 0), i);
    }
  } pieces;
  SerialExecutor serial;
  Grid<std::int32_t> whole, cut;
  const Grid<std::uint8_t> set = scattered(70, 90, 0.004, 5);
  DistanceTransform transform;
  transform.transform(set, serial, whole);
  transform.transform(set, pieces, cut);
  EXPECT_EQ(whole, cut);
}

}  // namespace
}  // namespace scree::fractal
