// scree dimension: what has no D, and what is asked wrongly: a message and an exit code, never a made-up D.

#include <cmath>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <utility>

#include "tests/integration/dimension_inputs.hpp"

namespace scree::test {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

TEST(DimensionBadInput, WhatHasNoDimensionIs65WithAReason) {
  const TemporaryFolder folder;
  std::string few, line, flat, plane;
  for (int i = 0; i < 40; ++i) {
    const std::string x = std::to_string(i % 8), y = std::to_string(i / 8);
    if (i < 19) few += x + ' ' + y + ' ' + std::to_string(i * i % 7) + '\n';
    line += x + ' ' + x + ".0 " + std::to_string(i) + '\n';
    line += std::to_string(0.1 * i) + ' ' + std::to_string(0.1 * i) + ' ' + std::to_string(i * i % 7) + '\n';
    flat += x + ' ' + y + " 2.5\n";
    plane += x + ' ' + y + ' ' + std::to_string(0.1 * (i % 8) - 0.3 * (i / 8)) + '\n';
  }
  std::string places, absent;
  for (int i = 0; i < 100; ++i) {
    places += std::to_string(i % 4) + ' ' + std::to_string(i / 4 % 4) + ' ' + std::to_string(i * i % 7) + '\n';
    absent += std::to_string(i % 10) + ' ' + std::to_string(i / 10) + (i % 2 ? " nan\n" : " inf\n");
  }
  const std::pair<std::string, const char*> cases[] = {{places, "100 points at 16"},
                                                       {absent, "none finite"},
                                                       {few, "at least 20 points, found 19"},
                                                       {line, "on one line"},
                                                       {flat, "all equal"},
                                                       {plane, "a plane has no D"},
                                                       {"", "points"},
                                                       {"x y\n1 2\n", "z"}};
  for (const auto& [text, reason] : cases) {
    const auto finished = scree({"dimension", write(folder, "bad.xyz", text)});
    EXPECT_EQ(finished.exit_code, 65) << reason << finished.out;
    EXPECT_THAT(finished.err, HasSubstr(reason));
    EXPECT_THAT(finished.err, HasSubstr("bad.xyz"));
    EXPECT_EQ(finished.out, "");
    const auto yokoya = scree({"dimension", (folder / "bad.xyz").string(), "--method", "yokoya"});
    EXPECT_EQ(yokoya.exit_code, 65) << reason << yokoya.out;
  }
}

TEST(DimensionBadInput, PointsInDegreesAreRefusedAndThoseOfASmallTableAreNot) {
  const TemporaryFolder folder;
  std::string degrees, table;
  for (int i = 0; i < 400; ++i) {
    const double x = 0.001 * (i % 20), y = 0.001 * (i / 20);
    degrees += fmt::format("{:.6f} {:.6f} {}\n", -105 + x, 40 + y, 1600 + i * i % 37);
    table += fmt::format("{:.6f} {:.6f} {:.6f}\n", x, y, 1e-5 * (i * i % 37));
  }
  const auto refused = scree({"dimension", write(folder, "lonlat.xyz", degrees)});
  EXPECT_EQ(refused.exit_code, 65);
  EXPECT_THAT(refused.err, HasSubstr("expected points in metres, found 36 of height over an extent of 0.019"));
  EXPECT_EQ(scree({"dimension", write(folder, "table.xyz", table)}).exit_code, 0);
}

TEST(DimensionBadInput, APictureHasNoSizeOfCellsAndThatIsSaid) {
#ifndef SCREE_WITH_GDAL
  GTEST_SKIP() << "this build reads no rasters";
#endif
  const TemporaryFolder folder;
  std::string picture = "P5\n30 30\n255\n";
  for (int i = 0; i < 900; ++i) picture += static_cast<char>(i * i % 101);
  const auto finished = scree({"dimension", write(folder, "depth.pgm", picture)});
  EXPECT_EQ(finished.exit_code, 0);
  EXPECT_THAT(finished.out, HasSubstr("cell_size_unknown"));
}

TEST(DimensionBadInput, EmptyAndGeographicRastersAreRefused) {
#ifndef SCREE_WITH_GDAL
  GTEST_SKIP() << "this build reads no rasters";
#endif
  const TemporaryFolder folder;
  const auto empty = scree({"dimension", write(folder, "empty.asc", esri_grid(kCell, 0, 0, true))});
  EXPECT_EQ(empty.exit_code, 65);
  EXPECT_THAT(empty.err, HasSubstr("nothing but nodata"));
  const auto degrees = write(folder, "degrees.asc", esri_grid(0.0001, -105, 40));
  const auto refused = scree({"dimension", degrees});
  EXPECT_EQ(refused.exit_code, 65);
  EXPECT_THAT(refused.err, HasSubstr("gdalwarp"));
  EXPECT_THAT(refused.err, HasSubstr("-tr 9.73 9.73"));  // 11.12 m by 8.52 m
  EXPECT_THAT(refused.err, HasSubstr("--geographic"));
  const auto json = estimate({degrees, "--geographic"});
  // Mean spacing: √(cells / known cells) of a cell's 8.53 m × 11.10 m at 40° north.
  EXPECT_NEAR(json["spacing_m"], std::sqrt(8.53 * 11.10 * 3600.0 / json["points"].get<double>()), 0.6);
  const auto metres = write(folder, "metres.asc", esri_grid(kCell, 1000, 2000));
  EXPECT_EQ(scree({"dimension", metres, "--geographic"}).exit_code, 65);
}

TEST(DimensionBadInput, UsageAndMissingInputsHaveTheirExitCodes) {
  EXPECT_EQ(scree({"dimension"}).exit_code, 64);
  EXPECT_EQ(scree({"dimension", "x.xyz", "--method", "guess"}).exit_code, 64);
  EXPECT_EQ(scree({"dimension", "x.xyz", "--noise-sigma-m", "-1"}).exit_code, 64);
  EXPECT_EQ(scree({"dimension", "x.xyz", "--noise-xy-sigma-m", "nan"}).exit_code, 64);
  EXPECT_EQ(scree({"dimension", "x.xyz", "--noise-sigma-m", "some"}).exit_code, 64);
  EXPECT_EQ(scree({"dimension", "x.xyz", "--max-lag-m", "-2"}).exit_code, 64);
  EXPECT_EQ(scree({"dimension", "x.xyz", "--segment", "spline"}).exit_code, 64);
  EXPECT_EQ(scree({"dimension", "x.xyz", "--segment", "polyline"}).exit_code, 64);  // not of the likelihood
  EXPECT_EQ(scree({"dimension", "x.xyz", "--frames", "2"}).exit_code, 64);
  EXPECT_EQ(scree({"dimension", "x.xyz", "--max-points", "-1"}).exit_code, 64);
  EXPECT_EQ(scree({"dimension", "x.xyz", "--geographic"}).exit_code, 64);
  EXPECT_EQ(scree({"dimension", "/nowhere/x.xyz"}).exit_code, 66);
  EXPECT_EQ(scree({"dimension", "/nowhere/x.tif"}).exit_code, 66);
  const TemporaryFolder folder;
  EXPECT_EQ(scree({"dimension", folder.path().string()}).exit_code, 66);  // a recording without its yaml
}

TEST(DimensionBadInput, ALongestLagBelowTheSpacingIsAUsageError) {
  const TemporaryFolder folder;
  const auto file = noisy_points(folder, 0.0, 0.0);
  for (const char* method : {"auto", "vecchia"}) {
    const auto finished = scree({"dimension", file, "--method", method, "--max-lag-m", "0.3"});
    EXPECT_EQ(finished.exit_code, 64);
    EXPECT_THAT(finished.err, HasSubstr("--max-lag-m: expected at least the mean spacing"));
  }
}

// Heights that change sign from cell to cell: changes fall with distance, and no surface has such a D.
TEST(DimensionBadInput, ALineWithoutADimensionIsNoDimension) {
  const TemporaryFolder folder;
  std::string text;
  for (int i = 0; i < 2500; ++i)
    text += std::to_string(i % 50) + ' ' + std::to_string(i / 50) + ' ' +
            std::to_string(((i % 50 + i / 50) % 2 ? 1.0 : -1.0) + 0.01 * (i * 7919 % 13)) + '\n';
  const auto file = write(folder, "board.xyz", text);
  for (const char* method : {"yokoya", "pentland"}) {
    const auto finished = scree({"dimension", file, "--method", method, "--json"});
    if (finished.exit_code != 0) continue;  // an error is no made-up D either
    const auto json = nlohmann::json::parse(finished.out);
    if (!json["dimension"].is_null()) {
      EXPECT_GE(json["dimension"], 2.0);
      EXPECT_LE(json["dimension"], 3.0);
      continue;
    }
    EXPECT_TRUE(json["amplitude_m"].is_null());
    EXPECT_THAT(json["flags"].dump(), HasSubstr("out_of_range"));
    EXPECT_THAT(scree({"dimension", file, "--method", method}).out, StartsWith("D unknown (no interval): the fitted"));
  }
}

TEST(DimensionBadInput, DuplicatesAreAveragedAndSaid) {
  const TemporaryFolder folder;
  const auto once = noisy_points(folder, 0.0, 0.0);
  const auto twice = write(folder, "twice.xyz", read_file(once) + read_file(once));
  const auto json = estimate({twice});
  EXPECT_EQ(json["duplicates"], 2500);
  EXPECT_EQ(json["points"], 2500);
  EXPECT_THAT(json["flags"].dump(), HasSubstr("duplicates_merged"));
  EXPECT_NEAR(json["dimension"], estimate({once})["dimension"], 1e-9);
}

TEST(DimensionBadInput, NoiseThatHidesTheGroundIsNoDimension) {
  const TemporaryFolder folder;
  const auto file = noisy_points(folder, 0.0, 0.0);
  const auto json = estimate({file, "--noise-sigma-m", "20"});
  EXPECT_TRUE(json["dimension"].is_null());
  EXPECT_TRUE(json["amplitude_m"].is_null());
  EXPECT_EQ(json["interval95"].dump(), "[2.0,3.0]");
  EXPECT_EQ(json["flags"][0], "noise_limited");
  EXPECT_THAT(scree({"dimension", file, "--noise-sigma-m", "20"}).out, StartsWith("D unknown"));
}

}  // namespace
}  // namespace scree::test
