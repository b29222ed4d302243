#include "node/dimension_maps.hpp"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>

#include "core/random.hpp"
#include "fractal/dimension_map.hpp"

namespace scree::node {
namespace {

/// Rough heights with holes: nothing fractal is needed.
SurveyGrid rough_grid(int rows, int columns) {
  SurveyGrid grid;
  grid.cell_m = 0.5;
  grid.height_m.assign(rows, columns, 0.0F);
  grid.variance_m2.assign(rows, columns, 1e-4F);
  grid.hits.assign(rows, columns, 0);
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c) {
      const auto words = random_words(3, 4, c, r);
      grid.height_m(r, c) = static_cast<float>(to_uniform(words[0]) + std::sin(0.1 * r) * std::cos(0.07 * c));
      if (to_uniform(words[1]) < 0.1) grid.height_m(r, c) = std::numeric_limits<float>::quiet_NaN();
    }
  return grid;
}

TEST(DimensionMaps, WindowIsTheSmallestOfWholeCellsThatIsWideEnough) {
  const SurveyGrid grid = rough_grid(40, 60);
  EXPECT_EQ(*window_radius(grid, 4.5), 4);
  EXPECT_EQ(*window_radius(grid, 4.6), 5);
  EXPECT_EQ(*window_radius(grid, 10.5), 10);
  EXPECT_EQ(*window_radius(grid, 1e9), 60);
  const auto narrow = window_radius(grid, 4.4);
  ASSERT_FALSE(narrow);
  EXPECT_EQ(narrow.error().kind, ErrorKind::usage);
}

TEST(DimensionMaps, StripsGiveTheMapOfTheWhole) {
  const SurveyGrid grid = rough_grid(140, 90);
  SerialExecutor executor;
  const auto strips = map_dimension(grid, 6, executor, 90 * 30);
  fractal::DimensionMapper mapper({grid.cell_m, 6});
  fractal::DimensionMap whole;
  mapper.update(grid.height_m, grid.variance_m2, grid.hits, executor, whole);
  int different = 0;
  float farthest = 0.0F;
  for (std::size_t i = 0; i < whole.dimension.size(); ++i) {
    different += std::isnan(whole.dimension[i]) != std::isnan(strips.dimension[i]) || whole.flags[i] != strips.flags[i];
    if (!std::isnan(whole.dimension[i]))
      farthest = std::max(farthest, std::abs(whole.dimension[i] - strips.dimension[i]));
  }
  EXPECT_EQ(different, 0);
  EXPECT_LT(farthest, 1e-5F);
}

}  // namespace
}  // namespace scree::node
