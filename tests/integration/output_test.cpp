// What the commands print and write: nothing lost in silence, nothing claimed that was not received.

#include <algorithm>
#include <cmath>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "fractal/dimension_map.hpp"
#include "io/npy.hpp"
#include "tests/integration/hand_made.hpp"
#include "tests/integration/scree.hpp"

namespace scree::test {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

/// The command with its standard output on a device that is always full.
Finished on_full_device(const std::vector<std::string>& arguments) {
  std::vector<std::string> shell{"/bin/sh", "-c", "exec \"$@\" >/dev/full", "sh", SCREE_BINARY};
  shell.insert(shell.end(), arguments.begin(), arguments.end());
  return run(shell);
}

TEST(Output, LostStandardOutputIsAnIoError) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";
  const TemporaryFolder folder;
  const auto recording = make_depth_recording(folder / "drive", every(0.1, 2));
  const std::string yaml = SCREE_SOURCE_DIR "/config/default.yaml";
  const std::vector<std::vector<std::string>> commands{
      replay(recording.string(), {"--rate", "max", "--json"}),
      {"listen", "--address", address(3), "--duration", "0.1", "--json"},
      {"config", "dump", yaml},
      {"config", "check", yaml},
      {"config", "keys"},
      {"--help"}};
  for (const auto& arguments : commands) {
    const auto finished = on_full_device(arguments);
    EXPECT_EQ(finished.exit_code, 74) << arguments[0] << ": " << finished.err;
    EXPECT_THAT(finished.err, HasSubstr("standard output: expected to take the result, found: No space left"));
  }
}

TEST(Output, ListenWithoutAMapHasTheSameKeysWithNulls) {
  const auto finished = scree({"listen", "--address", address(4), "--duration", "0.1", "--json"});
  ASSERT_EQ(finished.exit_code, 0) << finished.err;
  const json heard = json::parse(finished.out);
  for (const char* key : {"x_min_m", "y_min_m", "cell_m", "rows", "columns", "revision"}) {
    ASSERT_TRUE(heard.contains(key)) << key;
    EXPECT_TRUE(heard[key].is_null()) << key;
  }
  const TemporaryFolder folder;
  const auto wanted = scree(
      {"listen", "--address", address(4), "--duration", "0.1", "--json", "--map-out", (folder / "map.npy").string()});
  EXPECT_EQ(wanted.exit_code, 65);
  EXPECT_TRUE(json::parse(wanted.out)["cell_m"].is_null()) << "the statistics are printed all the same";
}

TEST(Output, ListenWritesOnlyTheLayersThatCome) {
  const TemporaryFolder folder;
  const auto recording = make_depth_recording(folder / "drive", every(0.1, 3));
  Process listener(
      command({"listen", "--address", address(0), "--json", "--map-out", (folder / "heard.npy").string()}));
  ASSERT_TRUE(listener.wait_for_text("listening at")) << listener.err();
  const auto node =
      scree(replay(recording.string(), {"--rate", "max", "--map-out", (folder / "sent.npy").string(), "--json"}));
  ASSERT_EQ(node.exit_code, 0) << node.err;
  const auto heard = listener.wait();
  ASSERT_EQ(heard.exit_code, 0) << heard.err;
  EXPECT_EQ(json::parse(heard.out)["cell_m"], 0.1);
  for (const char* layer : {"cost", "elevation", "dimension", "amplitude", "cell_state"})
    EXPECT_TRUE(std::filesystem::exists(folder / fmt::format("heard.{}.npy", layer))) << layer;
  for (const char* layer : {"slope", "step", "hits", "elevation_sigma", "dimension_sigma", "dimension_flags"}) {
    EXPECT_FALSE(std::filesystem::exists(folder / fmt::format("heard.{}.npy", layer))) << layer;
    EXPECT_TRUE(std::filesystem::exists(folder / fmt::format("sent.{}.npy", layer))) << layer;
  }
}

TEST(Output, DimensionFlagsMarkTheClampedDimensionOfAPlane) {
  const TemporaryFolder folder;
  const auto recording = make_depth_recording(folder / "drive", every(0.1, 3));
  const auto finished = scree(replay(recording.string(), {"--rate", "max", "--map-out", (folder / "m.npy").string()}));
  ASSERT_EQ(finished.exit_code, 0) << finished.err;
  const auto dimension = io::read_npy(folder / "m.dimension.npy");
  const auto flags = io::read_npy(folder / "m.dimension_flags.npy");
  ASSERT_TRUE(dimension && flags);
  ASSERT_EQ(flags->size(), dimension->size());
  int known = 0;
  for (std::size_t i = 0; i < flags->size(); ++i) {
    EXPECT_EQ(std::isnan((*flags)[i]), std::isnan((*dimension)[i])) << i;
    if (std::isnan((*flags)[i])) continue;
    ++known;
    EXPECT_NE(static_cast<int>((*flags)[i]) & fractal::kAtBound, 0) << "the ground is flat to the last bit";
  }
  EXPECT_GT(known, 100);
}

TEST(Output, FramesPerSecondCountsTheMapStageAlone) {
  const TemporaryFolder folder;
  const auto recording = make_depth_recording(folder / "drive", every(0.05, 20));
  const auto finished = scree(replay(recording.string(), {"--rate", "max", "--json"}));
  ASSERT_EQ(finished.exit_code, 0) << finished.err;
  const json statistics = json::parse(finished.out);
  const double mapping_s = statistics["mapping_s"];
  EXPECT_GT(mapping_s, 0.0);
  EXPECT_LT(mapping_s, statistics["elapsed_s"].get<double>());
  EXPECT_NEAR(statistics["frames_per_s"].get<double>() * mapping_s, 20.0, 1e-6);
}

TEST(Options, SeedIsANumberFromZeroOn) {
  for (const char* seed : {"-1", "1.5", "many", "99999999999999999999", ""}) {
    const auto finished = scree(replay("/nowhere/drive", {"--seed", seed}));
    EXPECT_EQ(finished.exit_code, 64) << seed << finished.err;
    EXPECT_THAT(finished.err, HasSubstr("--seed")) << seed;
  }
  EXPECT_EQ(scree(replay("/nowhere/drive", {"--seed", "7"})).exit_code, 66) << "a good one; only the drive is missing";
  EXPECT_EQ(scree({"simulate", "--terrain", "fbm:2.3,0.1,7,10,0.1", "--sensor", "depth", "--trajectory",
                   "line:0,0,0,1,1", "--out", "/dev/null/drive", "--seed", "-1"})
                .exit_code,
            64);
}

TEST(Options, LoopWithADurationIsRefused) {
  const auto finished = scree(replay("/nowhere/drive", {"--loop", "--duration", "0.3"}));
  EXPECT_EQ(finished.exit_code, 64);
  EXPECT_THAT(finished.err, HasSubstr("--duration: expected no --loop beside it"));
}

TEST(Options, TerrainInNoKnownFormatIsSaidInWholeSentences) {
  const TemporaryFolder folder;
  write_file(folder / "hill.dem", "not a raster\n");
  const auto finished = scree({"simulate", "--terrain", (folder / "hill.dem").string(), "--sensor", "depth",
                               "--trajectory", "line:0,0,0,1,1", "--out", (folder / "drive").string()});
  if (finished.exit_code == 69) GTEST_SKIP() << finished.err;  // a build without GDAL says so
  EXPECT_EQ(finished.exit_code, 65);
  EXPECT_THAT(finished.err, Not(HasSubstr("found \n")));
  EXPECT_THAT(finished.err, HasSubstr("hill.dem: expected a raster that GDAL reads, found"));
}

TEST(Input, FileThatContradictsTheChosenSensorIsABadConfiguration) {
  const TemporaryFolder folder;
  std::string file = "rows: 2\ncolumns: 2\n0 0 0\n0 0 0\n0 0 0\n0 0 0\n0 0 0\n0 0 0\n0 0 0\n0 0 0\n\n";
  file.append(16, '\1');
  write_file(folder / "u.perc", file);
  const auto whole = scree(replay((folder / "u.perc").string(), {"--config", SCREE_SOURCE_DIR "/config/pinhole.yaml"}));
  EXPECT_EQ(whole.exit_code, 78);
  EXPECT_THAT(whole.err,
              HasSubstr("u.perc: expected a 16-bit .pgm image (projection pinhole), found a range file: USF"));

  const auto recording = make_depth_recording(folder / "drive", every(0.1, 2));
  const auto other = scree(replay(recording.string(), {"--rate", "max", "--set", "sensor.projection=perceptron_usf"}));
  EXPECT_EQ(other.exit_code, 65);
  EXPECT_THAT(other.err, HasSubstr("(projection perceptron_usf), found a 16-bit .pgm image"));
}

}  // namespace
}  // namespace scree::test
