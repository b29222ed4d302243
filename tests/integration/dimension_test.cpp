// scree dimension: D of files of every kind, and what has no D.

#include <cmath>
#include <gmock/gmock.h>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>

#include "core/random.hpp"
#include "fractal/surface.hpp"
#include "tests/integration/scree.hpp"
#include "tests/support/shared_data.hpp"

namespace scree::test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

constexpr double kDimension = 2.4, kAmplitude = 0.2, kCell = 0.5;

/// Exact fBm as an ESRI grid, a third of its cells without data.
std::string esri_grid(double cell, double x, double y, bool empty = false) {
  const auto surface = *fractal::fbm_surface({kDimension, kAmplitude}, 60, 60, kCell, 11);
  std::ostringstream text;
  text.precision(9);
  text << "ncols 60\nnrows 60\nxllcorner " << x << "\nyllcorner " << y << "\ncellsize " << cell
       << "\nNODATA_value -9999\n";
  for (int r = 0; r < 60; ++r, text << '\n')
    for (int c = 0; c < 60; ++c)
      text << (empty || to_uniform(random_words(1, 2, c, r)[0]) < 0.33 ? -9999.0F : surface(r, c)) << ' ';
  return text.str();
}

std::string write(const TemporaryFolder& folder, const std::string& name, const std::string& text) {
  std::ofstream(folder / name, std::ios::binary) << text;
  return (folder / name).string();
}

nlohmann::json estimate(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "dimension");
  arguments.push_back("--json");
  const auto finished = scree(arguments);
  EXPECT_EQ(finished.exit_code, 0) << finished.err;
  return nlohmann::json::parse(finished.out);
}

// One fixed surface: that its interval holds the truth is one event of probability .95, its seed is fixed.
TEST(DimensionCommand, RasterOfKnownDimensionIsRecovered) {
#ifndef SCREE_WITH_GDAL
  GTEST_SKIP() << "this build reads no rasters";
#endif
  const TemporaryFolder folder;
  const auto file = write(folder, "dem.asc", esri_grid(kCell, 1000, 2000));
  const auto json = estimate({file});
  EXPECT_LT(json["interval95"][0], kDimension);
  EXPECT_GT(json["interval95"][1], kDimension);
  EXPECT_LT(json["interval95"][1].get<double>() - json["interval95"][0].get<double>(), 0.12);
  EXPECT_NEAR(json["amplitude_m"].get<double>() / kAmplitude, 1.0, 0.1);
  EXPECT_EQ(json["method"], "vecchia");
  EXPECT_EQ(json["points"].get<int>() + json["points_skipped"].get<int>(), 3600);
  EXPECT_THAT(json["flags"].dump(), Not(HasSubstr("scale_dependent")));
  EXPECT_THAT(json["flags"].dump(), Not(HasSubstr("methods_disagree")));

  const auto line = scree({"dimension", file});
  EXPECT_EQ(line.exit_code, 0);
  EXPECT_THAT(line.out, StartsWith("D = 2."));
  EXPECT_THAT(line.out, HasSubstr("noise 0 m assumed (--noise-sigma-m)"));
  EXPECT_EQ(scree({"dimension", file}).out, line.out);

  const auto part = estimate({file, "--max-points", "500"});
  EXPECT_EQ(part["points"], 500);
  EXPECT_EQ(part["flags"][0], "sampled");
  EXPECT_LT(part["interval95"][0], kDimension);
  EXPECT_GT(part["interval95"][1], kDimension);
}

TEST(DimensionCommand, TextPointsWithKnownNoiseAreRecovered) {
  const TemporaryFolder folder;
  const auto surface = *fractal::fbm_surface({kDimension, kAmplitude}, 60, 60, kCell, 12);
  std::ostringstream text;
  text << "x y z\n";
  for (int r = 0; r < 60; r += 1)
    for (int c = r % 3; c < 60; c += 3)
      text << kCell * c << ' ' << kCell * r << ' ' << surface(r, c) + 0.05 * random_normals(3, 4, c, r)[0] << '\n';
  text << "nan 0 0\n";
  const auto file = write(folder, "points.xyz", text.str());
  const auto json = estimate({file, "--noise-sigma-m", "0.05", "--method", "vecchia"});
  EXPECT_LT(json["interval95"][0], kDimension);
  EXPECT_GT(json["interval95"][1], kDimension);
  EXPECT_EQ(json["points"], 1200);
  EXPECT_EQ(json["noise_sigma_m"], 0.05);
  EXPECT_GT(estimate({file})["dimension"], json["dimension"]);  // unmodelled noise looks rough
}

// The paper's moments on one fixed surface of 3600 cells: an error of .15 is more than 4 of their standard deviations
// (docs/fractal.md: .04 at 10,000 points and lags to 25).
TEST(DimensionCommand, MomentsOfTheLiteratureFollowTheSurface) {
  const TemporaryFolder folder;
  const auto surface = *fractal::fbm_surface({kDimension, kAmplitude}, 60, 60, kCell, 13);
  std::ostringstream text;
  text.precision(9);
  for (int r = 0; r < 60; ++r)
    for (int c = 0; c < 60; ++c) text << kCell * c << ' ' << kCell * r << ' ' << surface(r, c) << '\n';
  const auto file = write(folder, "points.xyz", text.str());
  for (const char* method : {"yokoya", "pentland"})
    for (const char* segment : {"polyline", "least-squares"}) {
      const auto json = estimate({file, "--method", method, "--segment", segment, "--max-lag-m", "6"});
      EXPECT_NEAR(json["dimension"].get<double>(), kDimension, 0.15);
      EXPECT_NEAR(json["amplitude_m"].get<double>() / kAmplitude, 1.0, 0.2);
      EXPECT_EQ(json["method"], method);
      EXPECT_EQ(json["flags"].dump(), "[\"raw_heights\"]");
      EXPECT_LT(json["interval95"][0], json["dimension"]);
      EXPECT_GT(json["interval95"][1], json["dimension"]);
      EXPECT_GE(json["scale_range_m"][0], 0.9 * kCell);
      EXPECT_LE(json["scale_range_m"][1], 6.0 * 1.1);
    }
  EXPECT_EQ(estimate({file, "--method", "yokoya", "--noise-sigma-m", "0.1"})["dimension"],
            estimate({file, "--method", "yokoya"})["dimension"]);
  EXPECT_THAT(scree({"dimension", file, "--method", "pentland"}).out, HasSubstr("noise and tilt not taken off"));
  const auto near = scree({"dimension", file, "--method", "pentland", "--max-lag-m", "0.3"});
  EXPECT_EQ(near.exit_code, 65);
  EXPECT_THAT(near.err, HasSubstr("longest lag: expected at least"));
}

/// 50 × 50 points of an exact surface, half a metre apart, with noise of `sigma_m` on the heights and `xy_m` on both
/// coordinates, stretched along x.
std::string noisy_points(const TemporaryFolder& folder, double sigma_m, double xy_m, double stretch = 1.0) {
  const auto surface = *fractal::fbm_surface({kDimension, kAmplitude}, 50, 50, kCell, 14);
  std::ostringstream text;
  text.precision(9);
  for (int r = 0; r < 50; ++r)
    for (int c = 0; c < 50; ++c) {
      const auto n = random_normals(5, 6, c, r), m = random_normals(5, 7, c, r);
      text << stretch * (kCell * c + xy_m * m[0]) << ' ' << kCell * r + xy_m * m[1] << ' '
           << surface(r, c) + sigma_m * n[0] << '\n';
    }
  return write(folder, "noisy.xyz", text.str());
}

// One fixed surface each: that an interval holds the truth is an event of probability .95, the seed is fixed.
TEST(DimensionCommand, TheStructureFunctionKnowsNoiseOfAllCoordinates) {
  const TemporaryFolder folder;
  const auto file = noisy_points(folder, 0.05, 0.25);
  const auto json = estimate({file, "--noise-sigma-m", "0.05", "--noise-xy-sigma-m", "0.25"});
  EXPECT_EQ(json["method"], "structure-function");  // .5 spacings
  EXPECT_LT(json["interval95"][0], kDimension);
  EXPECT_GT(json["interval95"][1], kDimension);
  EXPECT_FALSE(json.contains("check"));
  const auto vertical = estimate({noisy_points(folder, 0.05, 0.0), "--noise-sigma-m", "0.05"});
  EXPECT_EQ(vertical["method"], "vecchia");
  EXPECT_EQ(vertical["check"]["method"], "structure-function");
  EXPECT_TRUE(vertical["check"]["agree"]);
  EXPECT_GT(vertical["scales"]["dimension"], 2.0);
  EXPECT_LT(vertical["scale_range_m"][0], vertical["scale_range_m"][1]);
}

TEST(DimensionCommand, NoiseIsEstimatedFromAThousandPoints) {
  const TemporaryFolder folder;
  const auto file = noisy_points(folder, 0.05, 0.0);
  const auto json = estimate({file, "--noise-sigma-m", "auto"});
  EXPECT_TRUE(json["noise_estimated"]);
  EXPECT_NEAR(json["noise_sigma_m"].get<double>(), 0.05, 0.025);
  EXPECT_LT(json["interval95"][0], kDimension);
  EXPECT_GT(json["interval95"][1], kDimension);
  EXPECT_THAT(scree({"dimension", file, "--noise-sigma-m", "auto"}).out, HasSubstr("m estimated"));
  const auto few = scree({"dimension", file, "--noise-sigma-m", "auto", "--max-points", "900"});
  EXPECT_EQ(few.exit_code, 65);
  EXPECT_THAT(few.err, HasSubstr("1000"));
  for (const char* method : {"structure-function", "yokoya", "pentland"}) {
    const auto finished = scree({"dimension", file, "--noise-sigma-m", "auto", "--method", method});
    EXPECT_EQ(finished.exit_code, 64);
    EXPECT_THAT(finished.err, HasSubstr("--noise-sigma-m auto: expected"));
  }
}

// Stretched three times along x: heights change most along y. Chi-square has power near 1 for twice on 21 × 21 cells
// (docs/fractal.md), and 5 % false alarms on the other, whose seed is fixed.
TEST(DimensionCommand, StretchedGroundIsAnisotropic) {
  const TemporaryFolder folder;
  const auto round = estimate({noisy_points(folder, 0.0, 0.0), "--anisotropy", "--cell-m", "0.5"});
  EXPECT_FALSE(round["anisotropy"]["significant"]) << round["anisotropy"];
  EXPECT_EQ(round["anisotropy"]["directional_dimension"].size(), 12u);
  const auto file = noisy_points(folder, 0.0, 0.0, 3.0);
  const auto json = estimate({file, "--anisotropy", "--cell-m", "1.5"});
  EXPECT_TRUE(json["anisotropy"]["significant"]);
  EXPECT_NEAR(json["anisotropy"]["direction_rad"].get<double>(), std::numbers::pi / 2, 0.3);
  EXPECT_THAT(json["flags"].dump(), HasSubstr("anisotropic"));
  const auto line = scree({"dimension", file, "--anisotropy", "--cell-m", "1.5"});
  EXPECT_THAT(line.out, HasSubstr("deg from +x"));
}

TEST(DimensionCommand, PointsOfARecordingAreThoseOfAllItsFrames) {
  const auto recording = small_recording().string();
  const auto json = estimate({recording, "--max-points", "5000"});
  EXPECT_EQ(json["recording"]["frames"], 7);
  EXPECT_EQ(json["points"].get<int>() + json["duplicates"].get<int>(), 5000);
  EXPECT_EQ(json["points_found"].get<int>() + json["points_skipped"].get<int>(), json["recording"]["pixels"]);
  EXPECT_GT(json["recording"]["sensor_noise_sigma_m"], 0.0);
  const auto two = estimate({recording, "--frames", "2", "--max-points", "5000"});
  EXPECT_EQ(two["recording"]["frames"], 2);
  EXPECT_LT(two["points_found"], json["points_found"]);
  EXPECT_EQ(estimate({recording, "--max-points", "5000"}), json);
  EXPECT_NE(estimate({recording, "--max-points", "5000", "--seed", "5"})["dimension"], json["dimension"]);
}

TEST(DimensionCommand, WhatHasNoDimensionIs65WithAReason) {
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
  const std::pair<std::string, const char*> cases[] = {
      {few, "at least 20 points, found 19"}, {line, "on one line"}, {flat, "all equal"},
      {plane, "a plane has no D"},           {"", "points"},        {"x y\n1 2\n", "z"}};
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

TEST(DimensionCommand, EmptyAndGeographicRastersAreRefused) {
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
  EXPECT_THAT(refused.err, HasSubstr("--geographic"));
  const auto json = estimate({degrees, "--geographic"});
  // Mean spacing: √(cells / known cells) of a cell's 8.53 m × 11.10 m at 40° north.
  EXPECT_NEAR(json["spacing_m"], std::sqrt(8.53 * 11.10 * 3600.0 / json["points"].get<double>()), 0.6);
  const auto metres = write(folder, "metres.asc", esri_grid(kCell, 1000, 2000));
  EXPECT_EQ(scree({"dimension", metres, "--geographic"}).exit_code, 65);
}

TEST(DimensionCommand, UsageAndMissingInputsHaveTheirExitCodes) {
  EXPECT_EQ(scree({"dimension"}).exit_code, 64);
  EXPECT_EQ(scree({"dimension", "x.xyz", "--method", "guess"}).exit_code, 64);
  EXPECT_EQ(scree({"dimension", "x.xyz", "--noise-sigma-m", "-1"}).exit_code, 64);
  EXPECT_EQ(scree({"dimension", "x.xyz", "--noise-xy-sigma-m", "nan"}).exit_code, 64);
  EXPECT_EQ(scree({"dimension", "x.xyz", "--noise-sigma-m", "some"}).exit_code, 64);
  EXPECT_EQ(scree({"dimension", "x.xyz", "--max-lag-m", "-2"}).exit_code, 64);
  EXPECT_EQ(scree({"dimension", "x.xyz", "--segment", "spline"}).exit_code, 64);
  EXPECT_EQ(scree({"dimension", "x.xyz", "--frames", "2"}).exit_code, 64);
  EXPECT_EQ(scree({"dimension", "x.xyz", "--geographic"}).exit_code, 64);
  EXPECT_EQ(scree({"dimension", "/nowhere/x.xyz"}).exit_code, 66);
  EXPECT_EQ(scree({"dimension", "/nowhere/x.tif"}).exit_code, 66);
  const TemporaryFolder folder;
  EXPECT_EQ(scree({"dimension", folder.path().string()}).exit_code, 66);  // a recording without its yaml
}

// Interpolated and rounded to whole metres: smooth between neighbours, rough across the valleys.
TEST(DimensionCommand, BrokenScalingOfARealDemIsSaid) {
  const auto dem = shared_data("bigtujunga_srtm30/srtm_bigtujunga30m_utm11.tif");
  SCREE_SKIP_WITHOUT(dem, "bigtujunga_srtm30");
  const auto json = estimate({dem->string(), "--max-points", "20000"});
  EXPECT_THAT(json["flags"].dump(), HasSubstr("scale_dependent"));
  EXPECT_THAT(json["flags"].dump(), HasSubstr("whole_metre_heights"));
  EXPECT_GT(json["coarse_dimension"], json["dimension"]);
}

}  // namespace
}  // namespace scree::test
