// scree plan and scree top as a user runs them.

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "tests/integration/hand_made.hpp"
#include "tests/integration/live_node.hpp"

namespace scree::test {
namespace {

Finished plan(std::vector<std::string> more) {
  std::vector<std::string> words{"plan"};
  words.insert(words.end(), more.begin(), more.end());
  return run(command(std::move(words)));
}

TEST(Plan, SaysWhatIsWrongWithItsOptions) {
  struct Case {
    std::vector<std::string> options;
    int code;
    const char* says;
  };
  for (const Case& wrong : std::vector<Case>{
           {{"--drive", "127.0.0.1:9"}, 64, "--goal"},
           {{"--goal", "1;2", "--drive", "127.0.0.1:9"}, 64, "expected X,Y in metres of the map, found '1;2'"},
           {{"--goal", "1,2", "--drive", "localhost"}, 64, "expected a numeric ADDRESS:PORT, found 'localhost'"},
           {{"--goal", "1,2", "--drive", "127.0.0.1:9", "--accept", "live,wish"}, 64, "found 'wish'"},
           {{"--goal", "1,2", "--drive", "127.0.0.1:9", "--terrain", "fbm:9"}, 64, "fbm"},
           {{"--goal", "1,2", "--drive", "127.0.0.1:9", "--address", "0.0.0.0:0"}, 69, "not all of them"}}) {
    const auto finished = plan(wrong.options);
    EXPECT_EQ(finished.exit_code, wrong.code) << finished.err;
    EXPECT_THAT(finished.err, ::testing::HasSubstr(wrong.says));
  }
}

// Nobody sends: it stands still until its time is over, and says so.
TEST(Plan, StandsStillWithoutAMap) {
  const auto finished =
      plan({"--goal", "1,2", "--drive", "127.0.0.1:9", "--node", "127.0.0.1:9", "--limit", "1", "--json"});
  EXPECT_EQ(finished.exit_code, 69) << finished.err;
  const auto json = nlohmann::json::parse(finished.out, nullptr, false);
  EXPECT_EQ(json["ended"], "timeout");
  EXPECT_EQ(json["path_m"], 0.0);
}

TEST(Top, ShowsARunningNode) {
  Ear ear;
  TemporaryFolder folder;
  write_file(folder / "robot.yaml",
             "source: {kind: simulated, terrain: \"fbm:2.3,0.1,7,20,0.1\", sensor: perceptron-cmu, "
             "trajectory: \"line:-5,0,0,8,0.1\"}\n");
  Process node(live(folder / "robot.yaml", ear,
                    {"--set", "publish.listen=127.0.0.1:0", "--set", "node.sensor_stale_ms=60000", "--set",
                     "node.sensor_lost_ms=60000"}));
  const auto listening = [&] { return node.err().find("listening at ") != std::string::npos; };
  ASSERT_TRUE(ear.until([&] { return listening() && ear->last_valid_map() != nullptr; })) << node.err();
  const std::string log = node.err();
  const std::size_t begin = log.find("listening at ") + 13;
  const std::string address = log.substr(begin, log.find('\n', begin) - begin);
  const auto top = run(command({"top", "--node", address, "--interval", "1", "--count", "3"}));
  ASSERT_EQ(top.exit_code, 0) << top.err;
  const std::string last = top.out.substr(top.out.rfind("FRESH"));
  for (const char* says : {"SIM", "health   ok", "frames   in", "latency  p50", "sensor   0: ok", "cells of 0.1 m",
                           "% unknown", "pose     x", "datagrams", "refused  none", "clock    node ahead"})
    EXPECT_THAT(last, ::testing::HasSubstr(says)) << top.out;
  EXPECT_EQ(top.out.find('\x1b'), std::string::npos) << "no control codes into a pipe";
}

}  // namespace
}  // namespace scree::test
