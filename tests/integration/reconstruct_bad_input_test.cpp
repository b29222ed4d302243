// scree reconstruct: what it is given wrongly, and what has no surface.

#include <filesystem>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <tuple>

#include "io/npy.hpp"
#include "tests/integration/dimension_inputs.hpp"

namespace scree::test {
namespace {

using ::testing::HasSubstr;

const std::vector<std::string> kGivenLaw{"--dimension", "2.4", "--amplitude-m", "0.2"};

struct Tool {
  TemporaryFolder folder;

  std::string points(const std::string& text) const { return write(folder, "points.xyz", text); }
  Finished run(const std::string& input, const std::vector<std::string>& more, bool law = true) const {
    std::vector<std::string> arguments{"reconstruct", input, "--cell", "0.5", "--out", (folder / "s.npy").string()};
    if (law) arguments.insert(arguments.end(), kGivenLaw.begin(), kGivenLaw.end());
    arguments.insert(arguments.end(), more.begin(), more.end());
    return scree(arguments);
  }
  void fails(const std::string& input, const std::vector<std::string>& more, int code, const char* message,
             bool law = true) const {
    const Finished finished = run(input, more, law);
    EXPECT_EQ(finished.exit_code, code) << message << finished.err;
    EXPECT_THAT(finished.err, HasSubstr(message));
    EXPECT_EQ(finished.out, "");
    EXPECT_FALSE(std::filesystem::exists(folder / "s.mean.npy"));
  }
};

/// 30 × 30 points half a metre apart.
std::string field() {
  std::string text;
  for (int i = 0; i < 900; ++i) text += fmt::format("{} {} {}\n", 0.5 * (i % 30), 0.5 * (i / 30), i * i % 37 * 0.01);
  return text;
}

TEST(ReconstructBadInput, OptionsThatCannotBeAre64) {
  const Tool tool;
  const auto input = tool.points(field());
  tool.fails(input, {"--extent", "0,0,10"}, 64, "expected XMIN,YMIN,XMAX,YMAX in metres, found '0,0,10'");
  tool.fails(input, {"--extent", "0,0,10,10,10"}, 64, "expected XMIN,YMIN,XMAX,YMAX");
  tool.fails(input, {"--extent", "0,0,nan,10"}, 64, "expected XMIN,YMIN,XMAX,YMAX");
  tool.fails(input, {"--extent", "5,0,5,10"}, 64, "expected XMAX above XMIN");
  tool.fails(input, {"--extent", "0,0,10.2,10"}, 64, "the nearest is --extent 0,0,10,10");
  tool.fails(input, {"--dimension", "3"}, 64, "--dimension: expected a number between 2 and 3, found 3", false);
  tool.fails(input, {"--dimension", "2"}, 64, "--dimension: expected a number between 2 and 3, found 2", false);
  tool.fails(input, {"--dimension", "2.4", "--amplitude-m", "0"}, 64,
             "--amplitude-m: expected metres above 1e-12 and below 1e6, found 0", false);
  tool.fails(input, {"--noise-sigma-m", "-1"}, 64, "--noise-sigma-m: expected metres of at least 0, or auto");
  tool.fails(input, {"--sweeps", "5"}, 64, "--sweeps: expected --method szeliski beside it, found conditional");
  tool.fails(input, {"--method", "szeliski", "--temperature", "hot"}, 64, "--temperature: expected empirical");
  tool.fails(input, {"--method", "magic"}, 64, "--method");
  tool.fails(input, {"--draws", "-1"}, 64, "--draws");
  EXPECT_EQ(scree({"reconstruct", input, "--out", (tool.folder / "s.npy").string()}).exit_code, 64) << "no --cell";
  EXPECT_EQ(scree({"reconstruct", input, "--cell", "0.5", "--out", (tool.folder / "s.jpg").string()}).exit_code, 64);
  EXPECT_EQ(scree({"reconstruct", input, "--cell", "0.5", "--out", "/nowhere/s.npy"}).exit_code, 73);
}

TEST(ReconstructBadInput, SamplesThatMakeNoSurfaceAre65) {
  const Tool tool;
  tool.fails(tool.points(""), {}, 65, "points");
  tool.fails(tool.points("0 0 nan\n1 1 inf\n"), {}, 65, "none finite");
  tool.fails(tool.points(field()), {"--extent", "100,100,110,110"}, 65, "found none (900 outside)");
  tool.fails(tool.points(field()), {"--extent", "0,0,50000,50000"}, 65,
             "expected at most 67108864 cells (8192 x 8192)");
  tool.fails(tool.points("0 0 1\n"), {}, 65, "give --dimension D --amplitude-m A", false);
  EXPECT_EQ(tool.run((tool.folder / "absent.xyz").string(), {}).exit_code, 66);
}

TEST(ReconstructBadInput, OneSampleIsALevelWithGrowingDoubt) {
  const Tool tool;
  const auto one = tool.points("5.25 5.25 3\n");
  for (const std::vector<std::string>& more :
       {std::vector<std::string>{}, {"--method", "kriging"}, {"--method", "membrane"}, {"--method", "szeliski"}}) {
    std::vector<std::string> arguments{"--extent", "0,0,10,10"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const auto finished = tool.run(one, arguments);
    ASSERT_EQ(finished.exit_code, 0) << finished.err;
    const auto mean = io::read_npy(tool.folder / "s.mean.npy"), sd = io::read_npy(tool.folder / "s.sd.npy");
    ASSERT_TRUE(mean && sd);
    for (const float z : *mean) EXPECT_NEAR(z, 3.0F, 0.05F);
    if (more.empty()) {
      EXPECT_GT((*sd)(0, 0), 5.0F * (*sd)(10, 10));
    }
  }
  const auto polyhedron = tool.run(one, {"--extent", "0,0,10,10", "--method", "polyhedron"});
  EXPECT_EQ(polyhedron.exit_code, 65);
  EXPECT_THAT(polyhedron.err, HasSubstr("expected at least 3 points, found 1"));
}

TEST(ReconstructBadInput, AllSamplesInOneCellAndContradictorySamplesAreAveraged) {
  const Tool tool;
  const auto finished =
      tool.run(tool.points("5.1 5.1 1\n5.4 5.4 3\n5.1 5.4 1\n5.4 5.1 3\n"), {"--extent", "0,0,10,10"});
  ASSERT_EQ(finished.exit_code, 0) << finished.err;
  EXPECT_NEAR((*io::read_npy(tool.folder / "s.mean.npy"))(10, 10), 2.0, 1e-3);
  const auto contrary = tool.run(tool.points("5.25 5.25 1\n5.25 5.25 3\n"), {"--extent", "0,0,10,10"});
  ASSERT_EQ(contrary.exit_code, 0) << contrary.err;
  EXPECT_NEAR((*io::read_npy(tool.folder / "s.mean.npy"))(10, 10), 2.0, 1e-3);
  EXPECT_THAT(contrary.err, HasSubstr("contradictory samples: heights at one place differ by 1.41 m"));
}

TEST(ReconstructBadInput, ManySamplesAtOnePlaceAreNoLongitudes) {
  const Tool tool;
  std::string text;
  for (int i = 0; i < 50; ++i) text += fmt::format("5.25 5.25 {}\n", 2.0 + 0.1 * (i % 7));
  const auto finished = tool.run(tool.points(text), {"--extent", "0,0,10,10"});
  ASSERT_EQ(finished.exit_code, 0) << finished.err;
  EXPECT_NEAR((*io::read_npy(tool.folder / "s.mean.npy"))(0, 0), 2.3, 0.05);
}

TEST(ReconstructBadInput, TheExtentThatAMessageNamesIsAccepted) {
  const Tool tool;
  const auto input = tool.points(field());
  const std::vector<std::string> odd{"reconstruct", input,    "--dimension", "2.4",   "--amplitude-m",
                                     "0.2",         "--cell", "0.1234567",   "--out", (tool.folder / "s.npy").string(),
                                     "--extent"};
  auto first = odd, second = odd;
  first.emplace_back("-1.6789,0.1,14.3,12");
  const auto refused = scree(first);
  EXPECT_EQ(refused.exit_code, 64);
  const auto at = refused.err.rfind("--extent ");
  ASSERT_NE(at, std::string::npos);
  std::string named = refused.err.substr(at + 9);
  second.push_back(named.substr(0, named.find('\n')));
  EXPECT_EQ(scree(second).exit_code, 0) << second.back();
}

// Cells that are no binary fractions: a row of samples may lie on the last border to the last bit.
TEST(ReconstructBadInput, TheDefaultExtentHoldsEverySample) {
#ifndef SCREE_WITH_GDAL
  GTEST_SKIP() << "this build reads no rasters";
#endif
  const Tool tool;
  for (const auto& [x, y, cell] : {std::tuple{-49.65, 2.7, 0.3}, {12.6, -7.35, 0.3}, {0.7, 0.1, 0.7}}) {
    std::string text = fmt::format("ncols 13\nnrows 8\nxllcorner {}\nyllcorner {}\ncellsize {}\n", x, y, cell);
    for (int i = 0; i < 104; ++i) text += fmt::format("{} ", 0.01 * (i * i % 17));
    const auto finished =
        scree({"reconstruct", write(tool.folder, "dem.asc", text), "--cell", fmt::format("{}", cell / 2), "--dimension",
               "2.4", "--amplitude-m", "0.2", "--json", "--out", (tool.folder / "s.npy").string()});
    ASSERT_EQ(finished.exit_code, 0) << finished.err;
    EXPECT_EQ(nlohmann::json::parse(finished.out)["samples_outside"], 0) << x << ' ' << y;
  }
}

TEST(ReconstructBadInput, ANodataValueIsNoCeiling) {
#ifndef SCREE_WITH_GDAL
  GTEST_SKIP() << "this build reads no rasters";
#endif
  const Tool tool;
  const auto rays =
      write(tool.folder, "rays.asc", "ncols 1\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 20\n-9999\n5\n");
  tool.fails(tool.points(field()), {"--ceiling", rays, "--extent", "0,0,10,30"}, 65, "found -9999 m in cell");
}

TEST(ReconstructBadInput, RoughestAndSmoothestLawsAreDrawnByKrigingToo) {
  const Tool tool;
  const auto input = tool.points(field());
  for (const char* dimension : {"2.01", "2.99"}) {
    const auto finished = scree({"reconstruct", input, "--cell", "0.5", "--method", "kriging", "--dimension", dimension,
                                 "--amplitude-m", "0.2", "--out", (tool.folder / "s.npy").string()});
    EXPECT_EQ(finished.exit_code, 0) << finished.err;
  }
}

}  // namespace
}  // namespace scree::test
