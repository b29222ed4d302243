// `scree run --record`: what is recorded live is replayed to the same map, whatever happens meanwhile.

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <signal.h>

#include "drivers/table.hpp"
#include "tests/integration/hand_made.hpp"
#include "tests/integration/live_node.hpp"

namespace scree::test {
namespace {

using nlohmann::json;
using namespace node::protocol;  // the health bits

/// A robot that stands until it is stopped.
std::vector<std::string> device(const std::string& sensor, const std::string& address, const std::string& period_s) {
  return command({"simulate", "--terrain", "fbm:2.3,0.1,7,20,0.1", "--sensor", sensor, "--trajectory",
                  "line:-5,0,0,2,0.5", "--frame-period", period_s, "--drive", "127.0.0.1:0", "--serve", address});
}

class Record : public ::testing::Test {
 protected:
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  std::string socket(const std::string& name) const { return "unix:" + path(name); }
  std::filesystem::path config(const std::string& text) const {
    write_file(folder_ / "robot.yaml", text);
    return folder_ / "robot.yaml";
  }
  std::filesystem::path one_source() const {
    return config("source: {kind: stream, address: \"" + socket("scanner") + "\", deadline_ms: 60000}\n");
  }
  bool until_mapped(std::uint64_t frames) {
    return ear_.until([&] {
      const auto map = ear_->last_valid_map();
      return map != nullptr && map->revision >= frames;
    });
  }
  json stop(Process& node) {
    node.signal(SIGINT);
    EXPECT_TRUE(ear_.until_bye());
    const auto finished = node.wait(seconds(60));
    EXPECT_EQ(finished.exit_code, 0) << finished.err;
    return json::parse(finished.out, nullptr, false);
  }
  /// Replays `recording` with the live run's configuration and compares every layer to the last bit.
  void expect_replay_gives(const std::string& live_map, const std::string& recording) {
    const auto replayed = scree({"replay", path(recording), "--config", path("robot.yaml"), "--set",
                                 "pose.source=recording", "--rate", "max", "--map-out", path("replayed.npy"), "--set",
                                 "publish.listen=127.0.0.1:0", "--set", "publish.destination=" + ear_.address()});
    ASSERT_EQ(replayed.exit_code, 0) << replayed.err;
    int layers = 0;
    for (const auto& entry : std::filesystem::directory_iterator(folder_.path())) {
      const std::string name = entry.path().filename().string();
      if (!name.starts_with(live_map + ".") || entry.path().extension() != ".npy") continue;
      EXPECT_EQ(read_file(entry.path()), read_file(folder_ / ("replayed" + name.substr(live_map.size())))) << name;
      ++layers;
    }
    EXPECT_GE(layers, 5);
  }

  TemporaryFolder folder_;
  Ear ear_;
};

TEST_F(Record, ReplayingARecordedLiveRunGivesItsMapByteForByte) {
  Process scanner(command({"simulate", "--terrain", "fbm:2.3,0.1,7,20,0.1", "--sensor", "perceptron-cmu",
                           "--trajectory", "line:-5,0,0,2,0.5", "--frame-period", "2", "--serve", socket("scanner")}));
  Process node(live(one_source(), ear_, {"--record", path("taken"), "--map-out", path("live.npy")}));
  ASSERT_TRUE(until_mapped(2)) << node.err();  // of three; a machine that is slow drops the second
  const json statistics = stop(node);
  ASSERT_GE(statistics["frames_mapped"], 2);
  EXPECT_EQ(statistics["recording"]["frames"], statistics["frames_mapped"]);
  EXPECT_EQ(statistics["recording"]["dropped"], 0);
  EXPECT_EQ(statistics["recording"]["refused"], 0);
  EXPECT_EQ(statistics["recording"]["restamped"], 0);
  EXPECT_THAT(read_file(folder_ / "taken" / "recording.yaml"), ::testing::HasSubstr("origin: sim"))
      << "what the device said of itself";
  expect_replay_gives("live", "taken");
}

TEST_F(Record, PosesByUdpAreRecordedWithTheirErrors) {
  Process node(live(config("source: {kind: stream, address: \"" + socket("scanner") +
                           "\", deadline_ms: 60000}\npose: {source: udp, max_age_ms: 60000}\n"),
                    ear_, {"--record", path("taken"), "--map-out", path("live.npy")}));
  ASSERT_TRUE(node.wait_for_text("listening at")) << node.err();
  auto words = device("perceptron-cmu", socket("scanner"), "1");
  words.insert(words.end(), {"--pose-out", listening_address(node.err())});
  Process scanner(words);
  ASSERT_TRUE(until_mapped(2)) << node.err();
  const json statistics = stop(node);
  EXPECT_EQ(statistics["recording"]["frames"], statistics["frames_mapped"]);
  expect_replay_gives("live", "taken");
}

TEST_F(Record, SeveralSourcesAreReplayedInTheOrderTheyWereMappedIn) {
  Process scanner(device("perceptron-cmu", socket("scanner"), "1"));
  Process camera(device("depth", socket("camera"), "0.7"));
  const auto text = "sources:\n  - {name: front, kind: stream, address: \"" + socket("scanner") +
                    "\", deadline_ms: 60000}\n  - {name: low, kind: stream, address: \"" + socket("camera") +
                    "\", deadline_ms: 60000, sensor: {range_max_m: 4}}\n" +
                    "pose: {source: static, T_map_body: {x_m: -5, y_m: 0, z_m: 1}}\n";
  Process node(live(config(text), ear_, {"--record", path("taken"), "--map-out", path("live.npy")}));
  ASSERT_TRUE(until_mapped(6)) << node.err();
  const json statistics = stop(node);
  ASSERT_EQ(statistics["sources"].size(), 2u);
  EXPECT_EQ(statistics["sources"][0]["name"], "front");
  for (const auto& source : statistics["sources"]) EXPECT_GE(source["frames_mapped"], 1) << source;
  EXPECT_EQ(statistics["recording"]["frames"], statistics["frames_mapped"]);
  const auto order = drivers::parse_order_table(read_file(folder_ / "taken" / "order.csv"), "order.csv");
  ASSERT_TRUE(order);
  EXPECT_EQ(order->size(), statistics["frames_mapped"]);
  EXPECT_THAT(read_file(folder_ / "taken" / "low" / "recording.yaml"), ::testing::HasSubstr("range_max_m: 4"));
  expect_replay_gives("live", "taken");
}

// A mapped frame is on its way to the disk at once, so at most the one that is being written is missing: the listener
// knows of `mapped` frames, of which the last may be it.
TEST_F(Record, AKilledNodeLosesAtMostTheFrameBeingWritten) {
  Process scanner(device("perceptron-cmu", socket("scanner"), "0.5"));
  Process node(live(one_source(), ear_, {"--record", path("taken")}));
  ASSERT_TRUE(until_mapped(4)) << node.err();
  node.signal(SIGKILL);
  const std::uint64_t mapped = ear_->last_valid_map()->revision;
  node.wait(seconds(60));
  std::string torn;
  const auto rows =
      drivers::parse_frames_table(read_file(folder_ / "taken" / "frames.csv"), "frames.csv", "frames", &torn);
  ASSERT_TRUE(rows) << rows.error().message;
  EXPECT_GE(rows->size() + 1, mapped);
  const auto replayed = scree(replay(path("taken"), {"--rate", "max", "--json"}));
  ASSERT_EQ(replayed.exit_code, 0) << replayed.err;
  const json statistics = json::parse(replayed.out);
  EXPECT_EQ(statistics["frames_mapped"], rows->size());
  EXPECT_EQ(statistics["frames_skipped"], 0);
}

// 300 KiB a file: a frame of 256 KiB fits, the poses of its 256 rows grow beyond it after some frames.
TEST_F(Record, AFullDiskEndsTheRecordingAndNotTheMap) {
  Process scanner(device("perceptron-cmu", socket("scanner"), "0.5"));
  auto words = live(one_source(), ear_, {"--record", path("taken")});
  std::string line = "trap '' XFSZ; ulimit -f 300; exec";  // bash counts KiB
  for (const auto& word : words) line += " '" + word + "'";
  Process node({"bash", "-c", line});
  ASSERT_TRUE(ear_.until_health(kHealthRecordingFailed, true)) << node.err();
  const auto map = ear_->last_valid_map();
  ASSERT_TRUE(until_mapped((map ? map->revision : 0) + 3)) << "the map goes on";
  const json statistics = stop(node);
  EXPECT_TRUE(statistics["recording"]["failed"]);
  EXPECT_GT(statistics["recording"]["dropped"], 0);
  EXPECT_EQ(statistics["recording"]["frames"].get<int>() + statistics["recording"]["dropped"].get<int>(),
            statistics["frames_mapped"]);
  EXPECT_EQ(occurrences(node.err(), "recording ended, the map goes on"), 1);
  const auto replayed = scree(replay(path("taken"), {"--rate", "max", "--json"}));
  ASSERT_EQ(replayed.exit_code, 0) << replayed.err;
  EXPECT_EQ(json::parse(replayed.out)["frames_mapped"], statistics["recording"]["frames"]);
}

TEST_F(Record, TheRestOfTheDiskIsLeftToOthers) {
  Process scanner(device("perceptron-cmu", socket("scanner"), "0.5"));
  const auto refused =
      run(live(one_source(), ear_, {"--record", path("taken"), "--set", "record.keep_free_mb=1000000"}));
  EXPECT_EQ(refused.exit_code, 73);
  EXPECT_THAT(refused.err, ::testing::HasSubstr("record.keep_free_mb"));
}

TEST_F(Record, WhatIsThereIsNotMixedWithWhatComes) {
  std::filesystem::create_directories(folder_ / "taken");
  write_file(folder_ / "taken" / "notes.txt", "mine");
  const auto refused = run(live(one_source(), ear_, {"--record", path("taken")}));
  EXPECT_EQ(refused.exit_code, 73) << refused.err;
  EXPECT_THAT(refused.err, ::testing::HasSubstr("expected a new or empty directory"));
}

}  // namespace
}  // namespace scree::test
