// The main job end to end.

#include <chrono>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <signal.h>
#include <thread>

#include "tests/integration/scree.hpp"

namespace scree::test {
namespace {

using nlohmann::json;

const std::vector<std::string> kLayers{"cost",       "elevation",      "dimension",       "amplitude",
                                       "cell_state", "slope",          "elevation_sigma", "dimension_sigma",
                                       "step",       "hits",           "cell_age",        "elevation_mean",
                                       "risk",       "dimension_flags"};

TEST(Replay, SameBytesAtAnyRateWithAnyNumberOfThreads) {
  const TemporaryFolder folder;
  const std::vector<std::vector<std::string>> variants{{"--rate", "max", "--set", "node.threads=1"},
                                                       {"--rate", "max", "--set", "node.threads=2"},
                                                       {"--rate", "1", "--set", "node.threads=1"},
                                                       {"--rate", "1", "--set", "node.threads=2"}};
  for (std::size_t i = 0; i < variants.size(); ++i) {
    auto options = variants[i];
    options.insert(options.end(), {"--map-out", (folder / (std::to_string(i) + ".npy")).string()});
    const auto finished = scree(replay(small_recording().string(), options));
    ASSERT_EQ(finished.exit_code, 0) << finished.err;
  }
  for (const auto& layer : kLayers) {
    const std::string first = read_file(folder / ("0." + layer + ".npy"));
    EXPECT_GT(first.size(), 100u) << layer;
    for (std::size_t i = 1; i < variants.size(); ++i)
      EXPECT_EQ(read_file(folder / (std::to_string(i) + "." + layer + ".npy")) == first, true) << layer << " of " << i;
  }
}

TEST(Replay, CountsEveryFrameAndPixel) {
  const auto finished = scree(replay(small_recording().string(), {"--rate", "max", "--json"}));
  ASSERT_EQ(finished.exit_code, 0) << finished.err;
  const json statistics = json::parse(finished.out);
  EXPECT_EQ(statistics["frames_in"], 7);
  EXPECT_EQ(statistics["frames_dropped"], 0);
  EXPECT_EQ(statistics["frames_mapped"], 7);
  EXPECT_GT(statistics["cells_measured"], 1000);
  EXPECT_GT(statistics["datagrams"], 100);
  const auto& pixels = statistics["pixels"];
  std::uint64_t sum = 0;
  for (const char* part :
       {"points", "no_return", "untrusted_row", "out_of_limits", "self", "speckle", "mixed", "ambiguous"})
    sum += pixels[part].get<std::uint64_t>();
  EXPECT_EQ(sum, pixels["pixels"].get<std::uint64_t>());
  EXPECT_EQ(pixels["pixels"], 7 * 256 * 256);
  std::uint64_t points = 0;
  for (const char* part : {"points_fused", "points_outside", "points_outlier", "points_other_surface"})
    points += statistics[part].get<std::uint64_t>();
  EXPECT_EQ(points, statistics["points"].get<std::uint64_t>());
}

TEST(Replay, ListenerReceivesTheWholeMap) {
  const TemporaryFolder folder;
  Process listener(command({"listen", "--address", address(0), "--json"}));
  ASSERT_TRUE(listener.wait_for_text("listening at")) << listener.err();
  const auto node = scree(replay(small_recording().string(), {"--rate", "max", "--json"}));
  ASSERT_EQ(node.exit_code, 0) << node.err;
  const auto heard = listener.wait();  // ends by itself at BYE
  ASSERT_EQ(heard.exit_code, 0) << heard.err;
  EXPECT_EQ(json::parse(heard.out)["cells_measured"], json::parse(node.out)["cells_measured"]);
  EXPECT_EQ(json::parse(heard.out)["origin"], "REPLAY");
}

TEST(Replay, ListenerThatComesFiveSecondsLateStillGetsTheWholeMap) {
  Process node(command(replay(small_recording().string(), {"--rate", "0.3", "--json"})));  // 10 s
  ASSERT_TRUE(node.wait_for_text("REPLAY")) << node.err();
  std::this_thread::sleep_for(std::chrono::seconds(5));
  Process listener(command({"listen", "--address", address(0), "--json"}));
  const auto heard = listener.wait(std::chrono::seconds(60));
  const auto finished = node.wait();
  ASSERT_EQ(heard.exit_code, 0) << heard.err;
  EXPECT_EQ(json::parse(heard.out)["cells_measured"], json::parse(finished.out)["cells_measured"]);
}

TEST(Replay, SigintStopsCleanlyAndStillPrintsTheResult) {
  Process node(command(replay(small_recording().string(), {"--loop", "--json"})));
  Process listener(command({"listen", "--address", address(0), "--json"}));
  ASSERT_TRUE(node.wait_for_text("info frames")) << node.err();  // the line of the first second
  std::this_thread::sleep_for(std::chrono::seconds(1));
  node.signal(SIGINT);
  const auto finished = node.wait(std::chrono::seconds(60));
  EXPECT_EQ(finished.exit_code, 0) << finished.err;
  EXPECT_GT(json::parse(finished.out)["frames_in"], 0);
  const auto heard = listener.wait(std::chrono::seconds(60));  // the node said BYE
  EXPECT_EQ(heard.exit_code, 0);
  EXPECT_EQ(json::parse(heard.out)["ended"], true);
}

TEST(Listen, SigtermAndDurationEndIt) {
  Process listener(command({"listen", "--address", address(2), "--json"}));
  ASSERT_TRUE(listener.wait_for_text("listening at"));
  listener.signal(SIGTERM);
  const auto finished = listener.wait(std::chrono::seconds(60));
  EXPECT_EQ(finished.exit_code, 0);
  EXPECT_EQ(json::parse(finished.out)["datagrams"], 0);
  EXPECT_EQ(scree({"listen", "--address", address(2), "--duration", "0.1"}).exit_code, 0);
}

}  // namespace
}  // namespace scree::test
