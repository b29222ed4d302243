// scree dimension: the files it writes, and what keeps it from writing them.

#include <cmath>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <sstream>

#include "core/random.hpp"
#include "fractal/surface.hpp"
#include "io/npy.hpp"
#include "io/raster.hpp"
#include "tests/integration/scree.hpp"

namespace scree::test {
namespace {

using ::testing::HasSubstr;

constexpr double kDimension = 2.5, kAmplitude = 0.2, kCell = 0.5;
constexpr int kSide = 80;

/// One point at a random place of every cell of an exact surface's lattice would not be fBm at those places: the
/// lattice itself is.
std::string points_file(const TemporaryFolder& folder) {
  const auto surface = *fractal::fbm_surface({kDimension, kAmplitude}, kSide, kSide, kCell, 21);
  std::ostringstream text;
  text.precision(9);
  for (int r = 0; r < kSide; ++r)
    for (int c = 0; c < kSide; ++c)
      text << 100 + kCell * (c + 0.5) << ' ' << 200 + kCell * (r + 0.5) << ' ' << surface(r, c) + 0.3 * c << '\n';
  std::ofstream(folder / "points.xyz") << text.str();
  return (folder / "points.xyz").string();
}

double mean_of(const Grid<float>& grid) {
  double sum = 0.0;
  int count = 0;
  for (const float value : grid)
    if (std::isfinite(value)) sum += static_cast<double>(value), ++count;
  return sum / count;
}

// 21 × 21 windows on 80 × 80 cells: about 15 independent ones with a standard deviation of .05 each, so .013 for the
// mean; cells hold one point each, at the centre, which the model takes for a random place.
TEST(DimensionOutput, MapsOfPointsAreGridsOfTheWholeSurvey) {
  const TemporaryFolder folder;
  const auto file = points_file(folder);
  const auto finished = scree(
      {"dimension", file, "--window-m", "10.5", "--cell-m", "0.5", "--out", (folder / "map.npy").string(), "--json"});
  ASSERT_EQ(finished.exit_code, 0) << finished.err;
  const auto maps = nlohmann::json::parse(finished.out)["maps"];
  EXPECT_EQ(maps["window_cells"], 21);
  EXPECT_EQ(maps["rows"], kSide);
  EXPECT_EQ(maps["known_cells"], kSide * kSide);
  for (const char* layer : {"dimension", "dimension_sigma", "amplitude", "dimension_flags"}) {
    const auto grid = io::read_npy(folder / ("map." + std::string(layer) + ".npy"));
    ASSERT_TRUE(grid) << grid.error().message;
    EXPECT_EQ(grid->rows(), kSide);
    EXPECT_EQ(grid->columns(), kSide);
  }
}

// A random 16 % of the places of a fine lattice, tilted, averaged in cells of their mean spacing: 200 × 200 of them, 90
// independent windows of 21 × 21 with a standard deviation of at most .09 each (docs/fractal.md: 30 % empty), so .01
// for the mean, 4 of those, and .02 for a bias.
TEST(DimensionOutput, MapsOfScatteredPointsHaveTheDimensionOfTheGround) {
  for (const double truth : {2.4, 2.7}) {
    const TemporaryFolder folder;
    constexpr int kFine = 500;
    const auto surface = *fractal::fbm_surface({truth, kAmplitude}, kFine, kFine, 0.2, 24);
    std::ofstream text(folder / "points.xyz");
    text.precision(9);
    for (int r = 0; r < kFine; ++r)
      for (int c = 0; c < kFine; ++c)
        if (to_uniform(random_words(7, 8, c, r)[0]) < 0.16)
          text << 0.2 * c << ' ' << 0.2 * r << ' ' << surface(r, c) + 0.5 * 0.2 * c << '\n';
    text.close();
    const auto finished = scree({"dimension", (folder / "points.xyz").string(), "--window-m", "10.5", "--out",
                                 (folder / "map.npy").string(), "--json"});
    ASSERT_EQ(finished.exit_code, 0) << finished.err;
    const auto json = nlohmann::json::parse(finished.out);
    EXPECT_NEAR(json["maps"]["cell_m"].get<double>(), 0.5, 0.02);
    EXPECT_NEAR(mean_of(*io::read_npy(folder / "map.dimension.npy")), truth, 0.06);
    EXPECT_NEAR(mean_of(*io::read_npy(folder / "map.amplitude.npy")) / kAmplitude, 1.0, 0.15);
  }
}

TEST(DimensionOutput, MapsOfARasterAreItsOwnCellsInItsPlace) {
#ifndef SCREE_WITH_GDAL
  GTEST_SKIP() << "this build writes no rasters";
#endif
  const TemporaryFolder folder;
  io::Raster dem{*fractal::fbm_surface({kDimension, kAmplitude}, kSide, 60, kCell, 22), 1000.0, 2000.0, kCell, kCell};
  ASSERT_TRUE(io::write_geotiff(folder / "dem.tif", dem));
  const auto out = (folder / "map.tif").string();
  const auto finished = scree({"dimension", (folder / "dem.tif").string(), "--window-m", "10", "--out", out});
  ASSERT_EQ(finished.exit_code, 0) << finished.err;
  EXPECT_THAT(finished.err, HasSubstr("windows of 21 x 21"));
  const auto map = io::read_raster(folder / "map.dimension.tif");
  ASSERT_TRUE(map) << map.error().message;
  EXPECT_EQ(map->x_min_m, 1000.0);
  EXPECT_EQ(map->y_min_m, 2000.0);
  EXPECT_EQ(map->cell_m, kCell);
  EXPECT_EQ(map->height_m.rows(), kSide);
  EXPECT_NEAR(mean_of(map->height_m), kDimension, 0.065);  // 5 standard deviations
  const auto amplitude = io::read_raster(folder / "map.amplitude.tif");
  ASSERT_TRUE(amplitude);
  EXPECT_NEAR(mean_of(amplitude->height_m) / kAmplitude, 1.0, 0.15);
}

TEST(DimensionOutput, PicturesAreWritten) {
#ifndef SCREE_WITH_PICTURES
  GTEST_SKIP() << "this build writes no pictures";
#endif
  const TemporaryFolder folder;
  const auto file = points_file(folder);
  for (const char* method : {"auto", "yokoya", "pentland"}) {
    const auto plot = folder / (std::string(method) + ".png");
    const auto finished = scree({"dimension", file, "--method", method, "--plot", plot.string(), "--window-m", "10",
                                 "--out", (folder / "map.png").string()});
    ASSERT_EQ(finished.exit_code, 0) << finished.err;
    EXPECT_EQ(read_file(plot).substr(1, 3), "PNG");
    EXPECT_EQ(read_file(folder / "map.dimension_sigma.png").substr(1, 3), "PNG");
  }
}

TEST(DimensionOutput, WhatCannotBeWrittenIsSaidFirst) {
  const TemporaryFolder folder;
  const auto file = points_file(folder);
  const auto npy = (folder / "m.npy").string();
  const auto fails = [&](std::vector<std::string> options, int exit_code, const std::string& reason) {
    options.insert(options.begin(), {"dimension", file});
    const auto finished = scree(options);
    EXPECT_EQ(finished.exit_code, exit_code) << reason << finished.err;
    EXPECT_THAT(finished.err, HasSubstr(reason));
    EXPECT_EQ(finished.out, "");
  };
  fails({"--out", npy}, 64, "expected --window-m W beside it");
  fails({"--window-m", "10"}, 64, "expected --out BASE.EXT beside it");
  fails({"--cell-m", "1"}, 64, "expected --anisotropy or --window-m and --out");
  fails({"--window-m", "-3", "--out", npy}, 64, "--window-m: expected metres above 0");
  fails({"--window-m", "10", "--out", (folder / "m.bmp").string()}, 64, "expected BASE.tif, BASE.npy or BASE.png");
  fails({"--window-m", "10", "--out", "/nowhere/m.npy"}, 73, "/nowhere/m.dimension.npy");
  fails({"--plot", (folder / "p.jpg").string()}, 64, "expected FILE.png");
#ifdef SCREE_WITH_PICTURES
  fails({"--plot", "/nowhere/p.png"}, 73, "/nowhere/p.png");
#endif
  fails({"--window-m", "2", "--out", npy}, 64, "expected a window of at least 9 cells");
  fails({"--window-m", "10", "--out", npy, "--cell-m", "1e-5"}, 65, "choose larger ones: --cell-m");
}

TEST(DimensionOutput, OblongCellsHaveNoMap) {
#ifndef SCREE_WITH_GDAL
  GTEST_SKIP() << "this build reads no rasters";
#endif
  const TemporaryFolder folder;
  io::Raster dem{*fractal::fbm_surface({kDimension, 30.0}, 60, 60, 1.0, 23), -105.0, 40.0, 0.0001, 0.0001, true};
  ASSERT_TRUE(io::write_geotiff(folder / "dem.tif", dem));
  const auto file = (folder / "dem.tif").string();
  const auto npy = (folder / "m.npy").string();
  EXPECT_EQ(scree({"dimension", file, "--geographic"}).exit_code, 0);
  const auto finished = scree({"dimension", file, "--geographic", "--window-m", "200", "--out", npy});
  EXPECT_EQ(finished.exit_code, 65);
  EXPECT_THAT(finished.err, HasSubstr("expected square cells"));
  EXPECT_THAT(finished.err, HasSubstr("gdalwarp"));
  dem.x_min_m = dem.y_min_m = 1000.0, dem.cell_m = dem.cell_y_m = 10.0, dem.geographic = false;
  ASSERT_TRUE(io::write_geotiff(folder / "metres.tif", dem));
  const auto metres = (folder / "metres.tif").string();
  EXPECT_EQ(scree({"dimension", metres, "--window-m", "200", "--out", npy, "--cell-m", "5"}).exit_code, 64);
}

}  // namespace
}  // namespace scree::test
