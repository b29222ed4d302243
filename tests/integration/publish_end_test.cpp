// What is left of a run when the map cannot be published as it should, and that slow pacing is no such case.

#include <filesystem>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "tests/integration/scree.hpp"

namespace scree::test {
namespace {

using nlohmann::json;

TEST(PublishEnd, LowestPacingDelaysTheEndButLosesNothing) {
  Process listener(command({"listen", "--address", address(1), "--json"}));
  ASSERT_TRUE(listener.wait_for_text("listening at")) << listener.err();
  const auto node =
      scree(replay(small_recording().string(), {"--rate", "max", "--json", "--set", "publish.destination=" + address(1),
                                                "--set", "publish.datagrams_per_s=100"}));
  ASSERT_EQ(node.exit_code, 0) << node.err;
  const auto heard = listener.wait();
  ASSERT_EQ(heard.exit_code, 0) << heard.err;
  const json statistics = json::parse(node.out);
  EXPECT_EQ(json::parse(heard.out)["cells_measured"], statistics["cells_measured"]);
  EXPECT_GT(statistics["publisher"]["blocks"], 300);
  EXPECT_GT(statistics["publisher"]["snapshots"], 0);
  EXPECT_EQ(statistics["publisher"]["snapshots_refused"], 0);
  EXPECT_EQ(statistics["publisher"]["send_blocked"], 0);
  EXPECT_TRUE(statistics["publisher"].contains("snapshots_superseded"));
  EXPECT_TRUE(statistics["publisher"].contains("cells_saturated"));
}

// A loopback interface of its own whose packets are shorter than a block's: a datagram is refused as too long.
TEST(PublishEnd, PublishingErrorComesAfterTheOutputs) {
  const std::vector<std::string> prefix{"unshare", "-rn", "sh", "-c", "ip link set lo mtu 600 up && exec \"$@\"", "sh"};
  auto possible = prefix;
  possible.push_back("true");
  if (run(possible).exit_code != 0) GTEST_SKIP() << "no network namespace can be made here";
  const TemporaryFolder folder;
  auto words = prefix;
  for (const auto& word : command(
           replay(small_recording().string(), {"--rate", "max", "--json", "--map-out", (folder / "map.npy").string(),
                                               "--snapshot", (folder / "map.png").string()})))
    words.push_back(word);
  const auto node = run(words);
  EXPECT_EQ(node.exit_code, 78) << node.err;
  EXPECT_THAT(node.err, ::testing::HasSubstr("too long"));
  EXPECT_EQ(json::parse(node.out)["frames_mapped"], 7);
  EXPECT_TRUE(std::filesystem::exists(folder / "map.cost.npy"));
  EXPECT_TRUE(std::filesystem::exists(folder / "map.json"));
  EXPECT_TRUE(std::filesystem::exists(folder / "map.png"));
}

}  // namespace
}  // namespace scree::test
