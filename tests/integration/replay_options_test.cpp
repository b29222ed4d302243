// --start, --duration, --loop, and the kinds of --map-out.

#include <cmath>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <signal.h>

#include "io/npy.hpp"
#include "io/picture.hpp"
#include "io/raster.hpp"
#include "tests/integration/hand_made.hpp"
#include "tests/integration/live_node.hpp"
#include "tests/integration/scree.hpp"

namespace scree::test {
namespace {

using nlohmann::json;

TEST(ReplayOptions, StartAndDurationChooseFramesByDataTime) {
  const TemporaryFolder folder;
  const auto recording = make_depth_recording(folder / "drive", every(0.25, 12, 40.0));  // 40 … 42.75 s
  const auto frames = [&](std::vector<std::string> options) {
    options.insert(options.end(), {"--rate", "max", "--json"});
    const auto finished = scree(replay(recording.string(), options));
    EXPECT_EQ(finished.exit_code, 0) << finished.err;
    return finished.exit_code == 0 ? json::parse(finished.out)["frames_mapped"].get<int>() : -1;
  };
  EXPECT_EQ(frames({}), 12);
  EXPECT_EQ(frames({"--start", "1"}), 8) << "from 41 s on";
  EXPECT_EQ(frames({"--duration", "1"}), 4) << "before 41 s";
  EXPECT_EQ(frames({"--start", "0.6", "--duration", "1"}), 4) << "40.75 … 41.5 s";
  const auto beyond = scree(replay(recording.string(), {"--start", "3"}));
  EXPECT_EQ(beyond.exit_code, 64);
  EXPECT_THAT(beyond.err, ::testing::HasSubstr("no frame in the chosen window: the recording's frames span 2.75 s"));
}

TEST(ReplayOptions, LoopGoesRoundUntilSigintAndDropsNothing) {
  const TemporaryFolder folder;
  const auto recording = make_depth_recording(folder / "drive", every(0.05, 6));
  Ear ear;
  Process node(
      command(replay(recording.string(), {"--loop", "--json", "--set", "publish.destination=" + ear.address()})));
  ASSERT_TRUE(ear.until([&] { return ear->frames_in() > 12; })) << node.err();  // the third time round
  node.signal(SIGINT);
  const auto finished = node.wait(std::chrono::seconds(60));
  ASSERT_EQ(finished.exit_code, 0) << finished.err;
  const json statistics = json::parse(finished.out);
  EXPECT_GT(statistics["frames_mapped"], 6);
  EXPECT_EQ(statistics["frames_dropped"], 0);
}

TEST(MapOut, RastersHoldTheSameValuesAsArrays) {
  const TemporaryFolder folder;
  const auto recording = make_depth_recording(folder / "drive", every(0.1, 2), 10.0);
  const auto npy = scree(replay(recording.string(), {"--rate", "max", "--map-out", (folder / "a.npy").string()}));
  ASSERT_EQ(npy.exit_code, 0) << npy.err;
  const auto tif = scree(replay(recording.string(), {"--rate", "max", "--map-out", (folder / "b.tif").string()}));
  if (tif.exit_code != 0 && tif.err.find("GDAL") != std::string::npos) GTEST_SKIP() << tif.err;  // a build without it
  ASSERT_EQ(tif.exit_code, 0) << tif.err;
  const json place = json::parse(read_file(folder / "a.json"));
  for (const char* layer : {"elevation", "cost", "cell_state", "hits"}) {
    const auto array = io::read_npy(folder / (std::string("a.") + layer + ".npy"));
    const auto raster = io::read_raster(folder / (std::string("b.") + layer + ".tif"));
    ASSERT_TRUE(array);
    ASSERT_TRUE(raster) << raster.error().message;
    ASSERT_EQ(raster->height_m.size(), array->size()) << layer;
    EXPECT_NEAR(raster->x_min_m, place["x_min_m"].get<double>(), 1e-9);
    EXPECT_NEAR(raster->y_min_m, place["y_min_m"].get<double>(), 1e-9);
    EXPECT_NEAR(raster->cell_m, place["cell_m"].get<double>(), 1e-12);
    std::size_t different = 0;
    for (std::size_t i = 0; i < array->size(); ++i) {
      const float a = (*array)[i], b = raster->height_m[i];
      if (a != b && !(std::isnan(a) && std::isnan(b))) ++different;
    }
    EXPECT_EQ(different, 0u) << layer;
  }
}

TEST(MapOut, PicturesAreOnePngALayer) {
  if (!io::picture_support()) GTEST_SKIP() << "this build cannot write pictures";
  const TemporaryFolder folder;
  const auto recording = make_depth_recording(folder / "drive", every(0.1, 2));
  const auto finished =
      scree(replay(recording.string(), {"--rate", "max", "--map-out", (folder / "map.png").string()}));
  ASSERT_EQ(finished.exit_code, 0) << finished.err;
  for (const char* layer : {"cost", "elevation", "dimension", "amplitude", "cell_state", "slope"}) {
    const std::string bytes = read_file(folder / (std::string("map.") + layer + ".png"));
    EXPECT_EQ(bytes.substr(0, 8), "\x89PNG\r\n\x1a\n") << layer;
  }
  EXPECT_TRUE(std::filesystem::exists(folder / "map.json"));
}

}  // namespace
}  // namespace scree::test
