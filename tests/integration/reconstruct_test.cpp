// scree reconstruct, end to end.

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "fractal/axis_dimension.hpp"
#include "fractal/surface.hpp"
#include "io/npy.hpp"
#include "io/raster.hpp"
#include "tests/integration/dimension_inputs.hpp"

namespace scree::test {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

constexpr int kSide = 96;
constexpr fractal::FractalLaw kLaw{kDimension, kAmplitude};
// Far from the origin, as surveys are; kSide cells of kCell are 48 m.
constexpr double kEast = 5e5, kNorth = 4e6;

Grid<float> truth() {
  return *fractal::fbm_surface(kLaw, kSide, kSide, kCell, 21);
}

bool sampled(int row, int column, double share) {
  return to_uniform(random_words(8, 9, column, row)[0]) < share;
}

/// Heights of the centres of a random part of the cells.
std::string sparse_points(const TemporaryFolder& folder, double share, const std::string& name = "sparse.xyz") {
  const Grid<float> surface = truth();
  std::string text;
  for (int r = 0; r < kSide; ++r)
    for (int c = 0; c < kSide; ++c)
      if (sampled(r, c, share))
        text +=
            fmt::format("{:.3f} {:.3f} {:.6f}\n", kEast + (c + 0.5) * kCell, kNorth + (r + 0.5) * kCell, surface(r, c));
  return write(folder, name, text);
}

std::vector<std::string> reconstruct(const TemporaryFolder& folder, const std::string& input,
                                     const std::vector<std::string>& more = {}) {
  std::vector<std::string> arguments{"reconstruct", input, "--cell", "0.5", "--out", (folder / "s.npy").string()};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

const std::string kWhole = fmt::format("{},{},{},{}", kEast, kNorth, kEast + kSide * kCell, kNorth + kSide * kCell);

Grid<float> layer(const TemporaryFolder& folder, const std::string& name) {
  auto grid = io::read_npy(folder / ("s." + name + ".npy"));
  EXPECT_TRUE(grid) << name;
  return grid ? *std::move(grid) : Grid<float>();
}

double rmse(const Grid<float>& a, const Grid<float>& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += std::pow(static_cast<double>(a[i] - b[i]), 2);
  return std::sqrt(sum / static_cast<double>(a.size()));
}

// One surface of 96 × 96 cells, 10 % of them known, everything estimated. D of 922 clean points has a standard
// deviation of .025: .1 is 4 of them. The draw's D differs from the truth's own by .014 at most in 21 surfaces (256²);
// sampling on the smaller grid doubles that: .06 with the error of the estimate. 90 % intervals of some 8300 correlated
// cells, the law being estimated too: .80 to .97.
TEST(Reconstruct, PointsBecomeARoughSurfaceWithItsUncertainty) {
  const TemporaryFolder folder;
  const auto points = sparse_points(folder, 0.1);
  const auto finished = scree(reconstruct(folder, points, {"--extent", kWhole, "--draws", "2", "--json"}));
  ASSERT_EQ(finished.exit_code, 0) << finished.err;
  const json report = json::parse(finished.out);
  EXPECT_EQ(report["method"], "conditional");
  EXPECT_NEAR(report["dimension"].get<double>(), kDimension, 0.1);
  EXPECT_NEAR(report["amplitude_m"].get<double>() / kAmplitude, 1.0, 0.2);
  EXPECT_EQ(report["rows"], kSide);
  EXPECT_EQ(report["noise_source"], "assumed, 1 % of the change over a cell");
  EXPECT_GT(report["iterations"], 0);
  EXPECT_GT(report["seconds"], 0.0);
  EXPECT_TRUE(report["converged"].get<bool>());

  const Grid<float> mean = layer(folder, "mean"), sd = layer(folder, "sd"), draw = layer(folder, "draw0");
  ASSERT_EQ(mean.rows(), kSide);
  EXPECT_NEAR(report["dimension_of_draw"].get<double>(), fractal::axis_dimension(draw), 1e-9);
  EXPECT_NEAR(fractal::axis_dimension(draw), fractal::axis_dimension(truth()), 0.06);
  EXPECT_LT(fractal::axis_dimension(mean), fractal::axis_dimension(truth()) - 0.1) << "a mean is smoother";
  EXPECT_NE(layer(folder, "draw1"), draw);
  const Grid<float> z = truth();
  double covered = 0.0;
  for (std::size_t i = 0; i < z.size(); ++i) covered += std::abs(z[i] - mean[i]) < 1.645F * sd[i] ? 1.0 : 0.0;
  EXPECT_GT(covered / static_cast<double>(z.size()), 0.80);
  EXPECT_LT(covered / static_cast<double>(z.size()), 0.97);
  // The mean errs by what kriging of data 3.2 cells apart leaves, about .9 of the change over a cell.
  EXPECT_LT(rmse(mean, z), 1.3 * kLaw.rms_change_m(kCell));
  EXPECT_NEAR(rmse(draw, z) / rmse(mean, z), std::sqrt(2.0), 0.15);
}

TEST(Reconstruct, TheHumanLineSaysWhatWasAssumed) {
  const TemporaryFolder folder;
  const auto finished = scree(reconstruct(folder, sparse_points(folder, 0.1)));
  EXPECT_EQ(finished.exit_code, 0);
  EXPECT_THAT(finished.out, HasSubstr("conditional: 9"));
  EXPECT_THAT(finished.out, HasSubstr("assumed, 1 % of the change over a cell"));
  EXPECT_THAT(finished.out, HasSubstr("D of the draw"));
}

TEST(Reconstruct, TheSeedDecidesTheDrawAndNothingElse) {
  const TemporaryFolder folder;
  const auto points = sparse_points(folder, 0.1);
  const auto make = [&](const char* seed) {
    EXPECT_EQ(scree(reconstruct(folder, points, {"--seed", seed})).exit_code, 0);
    return std::pair(layer(folder, "draw0"), layer(folder, "mean"));
  };
  const auto first = make("5"), again = make("5"), other = make("6");
  EXPECT_EQ(first, again);
  EXPECT_NE(first.first, other.first);
  EXPECT_EQ(first.second, other.second);
}

TEST(Reconstruct, EveryMethodFillsTheGridFromTheSameSamples) {
  const TemporaryFolder folder;
  const auto points = sparse_points(folder, 0.1);
  const Grid<float> z = truth();
  const double unit = kLaw.rms_change_m(kCell);
  for (const char* method :
       {"conditional", "szeliski", "polyhedron", "barycentre", "thin-plate", "membrane", "kriging"}) {
    const auto finished = scree(
        reconstruct(folder, points,
                    {"--extent", kWhole, "--method", method, "--dimension", "2.4", "--amplitude-m", "0.2", "--json"}));
    ASSERT_EQ(finished.exit_code, 0) << method << finished.err;
    EXPECT_EQ(json::parse(finished.out)["method"], method);
    const Grid<float> mean = layer(folder, "mean");
    double sum = 0.0, cells = 0.0;
    for (std::size_t i = 0; i < z.size(); ++i)
      if (!std::isnan(mean[i])) sum += std::pow(static_cast<double>(mean[i] - z[i]), 2), cells += 1.0;
    EXPECT_GT(cells, 0.9 * static_cast<double>(z.size())) << method << ": the hull of the samples holds more";
    EXPECT_LT(std::sqrt(sum / cells), 1.5 * unit) << method;
    EXPECT_EQ(layer(folder, "draw0").rows(), kSide) << method;
  }
}

TEST(Reconstruct, RegularSamplesServeYokoya) {
  const TemporaryFolder folder;
  const Grid<float> z = truth();
  std::string text;
  for (int r = 0; r < kSide; r += 4)
    for (int c = 0; c < kSide; c += 4) text += fmt::format("{} {} {}\n", (c + 0.5) * kCell, (r + 0.5) * kCell, z(r, c));
  const auto finished = scree(reconstruct(folder, write(folder, "regular.xyz", text), {"--method", "yokoya"}));
  EXPECT_EQ(finished.exit_code, 0) << finished.err;
  EXPECT_FLOAT_EQ(layer(folder, "draw0")(4, 8), z(4, 8));
  const auto irregular = scree(reconstruct(folder, sparse_points(folder, 0.1), {"--method", "yokoya"}));
  EXPECT_EQ(irregular.exit_code, 65) << irregular.out;
}

TEST(Reconstruct, HolesOfARasterAreFilledOnItsOwnGridAndItsPlaceIsKept) {
#ifndef SCREE_WITH_GDAL
  GTEST_SKIP() << "this build reads no rasters";
#endif
  const TemporaryFolder folder;
  const auto dem = write(folder, "dem.asc", esri_grid(kCell, 1000, 2000));
  const auto out = (folder / "full.tif").string();
  const auto finished = scree({"reconstruct", dem, "--out", out, "--json"});
  ASSERT_EQ(finished.exit_code, 0) << finished.err;
  const auto mean = io::read_raster(folder / "full.mean.tif");
  ASSERT_TRUE(mean);
  EXPECT_EQ(mean->x_min_m, 1000.0);
  EXPECT_EQ(mean->y_min_m, 2000.0);
  EXPECT_EQ(mean->height_m.rows(), 60);
  EXPECT_TRUE(std::none_of(mean->height_m.begin(), mean->height_m.end(), [](float v) { return std::isnan(v); }));
}

TEST(Reconstruct, RastersGiveALawToEveryCell) {
#ifndef SCREE_WITH_GDAL
  GTEST_SKIP() << "this build reads no rasters";
#endif
  const TemporaryFolder folder;
  const auto points = sparse_points(folder, 0.1);
  const auto raster = [&](const char* name, const char* west, const char* east, int rows = 2) {
    std::string text = fmt::format("ncols 2\nnrows {}\nxllcorner {}\nyllcorner {}\ncellsize {}\nNODATA_value -9999\n",
                                   rows, kEast, kNorth, kSide * kCell / 2);
    for (int r = 0; r < rows; ++r) text += fmt::format("{} {}\n", west, east);
    return write(folder, name, text);
  };
  const auto dimension = raster("d.asc", "2.2", "2.7"), amplitude = raster("a.asc", "0.05", "0.4");
  const auto finished = scree(reconstruct(
      folder, points, {"--extent", kWhole, "--dimension", dimension, "--amplitude-m", amplitude, "--json"}));
  ASSERT_EQ(finished.exit_code, 0) << finished.err;
  EXPECT_TRUE(json::parse(finished.out)["law_varies"].get<bool>());
  const Grid<float> sd = layer(folder, "sd");
  double west = 0.0, east = 0.0;
  for (int r = 0; r < kSide; ++r)
    for (int c = 0; c < kSide / 2 - 8; ++c)
      west += static_cast<double>(sd(r, c)), east += static_cast<double>(sd(r, kSide - 1 - c));
  EXPECT_GT(east, 4.0 * west) << "the law there is 8 times as rough at 1 m, and D larger";

  const auto fails = [&](const std::vector<std::string>& more, int code, const char* message) {
    const auto result = scree(reconstruct(folder, points, more));
    EXPECT_EQ(result.exit_code, code) << result.err;
    EXPECT_THAT(result.err, HasSubstr(message));
  };
  fails({"--dimension", dimension, "--extent", kWhole}, 64, "expected --amplitude-m A or FILE beside it");
  fails({"--dimension", raster("half.asc", "2.2", "2.7", 1), "--amplitude-m", "0.2", "--extent", kWhole}, 65,
        "found nothing there");
  fails({"--dimension", raster("wild.asc", "2.2", "3.2"), "--amplitude-m", "0.2", "--extent", kWhole}, 65,
        "expected a number between 2 and 3");
}

TEST(Reconstruct, OutliersAreLeftOutAndSaid) {
  const TemporaryFolder folder;
  const auto points = sparse_points(folder, 0.1);
  std::string text = read_file(points);
  const double unit = kLaw.rms_change_m(kCell);
  const Grid<float> z = truth();
  // Far from each other, in cells without a sample, 20 changes over a cell above the ground.
  for (int k = 0; k < 5; ++k) {
    const int r = 40 + 7 * (k % 2);
    int c = 16 + 15 * k;
    while (sampled(r, c, 0.1)) ++c;
    text += fmt::format("{:.3f} {:.3f} {:.6f}\n", kEast + (c + 0.5) * kCell, kNorth + (r + 0.5) * kCell,
                        static_cast<double>(z(r, c)) + 20.0 * unit);
  }
  const auto spoilt = write(folder, "spoilt.xyz", text);
  const std::vector<std::string> law{"--extent", kWhole, "--dimension", "2.4", "--amplitude-m", "0.2", "--json"};
  const auto with = [&](const std::string& input, const std::vector<std::string>& more) {
    std::vector<std::string> arguments = law;
    arguments.insert(arguments.end(), more.begin(), more.end());
    const auto finished = scree(reconstruct(folder, input, arguments));
    EXPECT_EQ(finished.exit_code, 0) << finished.err;
    return std::pair(json::parse(finished.out)["rejected_cells"].get<int>(), rmse(layer(folder, "mean"), z));
  };
  const auto clean = with(points, {}), gated = with(spoilt, {}), kept = with(spoilt, {"--keep-outliers"});
  EXPECT_EQ(clean.first, 0);
  EXPECT_EQ(gated.first, 5);
  EXPECT_EQ(kept.first, 0);
  EXPECT_LT(gated.second, 1.03 * clean.second);
  EXPECT_GT(kept.second, 1.2 * clean.second);
}

TEST(Reconstruct, ALawThatTheSamplesContradictLeavesNoneOfThemOut) {
  const TemporaryFolder folder;
  const auto points = sparse_points(folder, 0.1);
  for (const char* amplitude : {"1e-5", "0.02"}) {  // a 20,000th, a tenth of what it is
    const auto finished =
        scree(reconstruct(folder, points, {"--dimension", "2.01", "--amplitude-m", amplitude, "--json"}));
    ASSERT_EQ(finished.exit_code, 0) << finished.err;
    const json report = json::parse(finished.out);
    EXPECT_TRUE(report["law_contradicted"].get<bool>()) << amplitude;
    EXPECT_EQ(report["rejected_cells"], 0);
  }
}

// Two regions, a law of 40 times the amplitude in the west. By the conditional law of the three corners displacements
// are proportional to the amplitude, so the spreads differ by 40 times what the places of the samples make of either
// half: 8 realisations of 2900 cells each err by 1 %, the two geometries by some percent, 20 % are many of them. `auto`
// in the east finds the law that its ground was made with from 460 clean points: D to .035 and the change over a
// spacing to 3 %, 30 % are 4 standard deviations of the change over a metre.
TEST(Reconstruct, RegionsOfInfluenceHaveTheirOwnLawGivenOrEstimated) {
  const TemporaryFolder folder;
  const auto points = sparse_points(folder, 0.1);
  const auto rough = [&](const std::string& east, const std::string& west) {
    const std::string text = fmt::format("x_m,y_m,dimension,amplitude_m\n{},{},{}\n{},{},{}\n", kEast + 12.0,
                                         kNorth + 24.0, west, kEast + 36.0, kNorth + 24.0, east);
    const auto finished =
        scree(reconstruct(folder, points,
                          {"--extent", kWhole, "--method", "barycentre", "--dimension", "2.4", "--amplitude-m", "0.2",
                           "--barycentre-law", "conditional", "--regions", write(folder, "r.csv", text)}));
    EXPECT_EQ(finished.exit_code, 0) << finished.err;
    const Grid<float> sd = layer(folder, "sd");
    double sums[2] = {0.0, 0.0};
    for (int r = 10; r < kSide - 10; ++r)
      for (int c = 10; c < kSide - 10; ++c)
        if (std::abs(c - kSide / 2) > 8 && std::isfinite(sd(r, c)))
          sums[c < kSide / 2 ? 0 : 1] += static_cast<double>(sd(r, c));
    return std::pair(sums[0], sums[1]);
  };
  const auto known = rough("2.4,0.2", "2.4,8"), estimated = rough("auto,auto", "2.4,8");
  EXPECT_NEAR(known.first / known.second, 40.0, 8.0);
  EXPECT_NEAR(estimated.second / known.second, 1.0, 0.3);
  EXPECT_NEAR(estimated.first / known.first, 1.0, 1e-3);
}

TEST(Reconstruct, ACeilingKeepsTheSurfaceBelowIt) {
#ifndef SCREE_WITH_GDAL
  GTEST_SKIP() << "this build reads no rasters";
#endif
  const TemporaryFolder folder;
  const auto points = sparse_points(folder, 0.02);
  const std::vector<std::string> law{"--extent", kWhole, "--dimension", "2.4", "--amplitude-m", "0.2", "--json"};
  ASSERT_EQ(scree(reconstruct(folder, points, law)).exit_code, 0);
  const Grid<float> free = layer(folder, "draw0");
  const float level =
      0.5F * (*std::min_element(free.begin(), free.end()) + *std::max_element(free.begin(), free.end()));
  const auto rays = write(folder, "rays.asc",
                          fmt::format("ncols 1\nnrows 1\nxllcorner {}\nyllcorner {}\ncellsize {}\nNODATA_value "
                                      "-9999\n{}\n",
                                      kEast, kNorth, kSide * kCell, level));
  std::vector<std::string> more = law;
  more.insert(more.end(), {"--ceiling", rays});
  ASSERT_EQ(scree(reconstruct(folder, points, more)).exit_code, 0);
  const Grid<float> held = layer(folder, "draw0");
  const auto above = [level](const Grid<float>& z) {
    return std::count_if(z.begin(), z.end(), [level](float height) { return height > level; });
  };
  // Samples above the ceiling stay, they contradict it; most of the rest of what stood above is pushed down.
  EXPECT_LT(above(held), above(free) / 2);
}

TEST(Reconstruct, RepeatedSamplesTellTheNoise) {
  const TemporaryFolder folder;
  std::string text;
  const Grid<float> z = truth();
  for (int r = 0; r < kSide; r += 3)
    for (int c = 0; c < kSide; c += 3)
      for (int k = 0; k < 2; ++k)
        text += fmt::format(
            "{} {} {}\n", (c + 0.5) * kCell, (r + 0.5) * kCell,
            static_cast<double>(z(r, c)) + 0.05 * random_normals(4, static_cast<std::uint64_t>(k), c, r)[0]);
  const auto finished = scree(reconstruct(folder, write(folder, "twice.xyz", text), {"--json"}));
  ASSERT_EQ(finished.exit_code, 0) << finished.err;
  const json report = json::parse(finished.out);
  EXPECT_EQ(report["noise_source"], "from repeated samples");
  // 1024 degrees of freedom: 2.2 % of standard error, 4.5 of them
  EXPECT_NEAR(report["noise_sigma_m"].get<double>(), 0.05, 0.05 * 0.1);
}

}  // namespace
}  // namespace scree::test
