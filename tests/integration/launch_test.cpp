// The launch files, run as a user runs them.

#include <gmock/gmock.h>

#include "io/picture.hpp"
#include "tests/integration/scree.hpp"

namespace scree::test {
namespace {

class Launch : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!io::picture_support()) GTEST_SKIP() << "this build cannot write pictures, which launch files leave behind";
  }

  /// In `folder_`, with the binary under test and a short drive over a small terrain.
  Finished launch(const std::string& file, std::vector<std::string> arguments = {}) const {
    std::vector<std::string> words{"env",
                                   "-C",
                                   folder_.path().string(),
                                   "SCREE=" SCREE_BINARY,
                                   "SCREE_ADDRESS=127.0.0.1:0",
                                   "TMPDIR=" + folder_.path().string(),
                                   "SCREE_TERRAIN=fbm:2.3,0.1,7,30,0.1",
                                   "SCREE_TRAJECTORY=line:-6,0,0,2,1.0",
                                   SCREE_SOURCE_DIR "/launch/" + file};
    words.insert(words.end(), arguments.begin(), arguments.end());
    return run(std::move(words));
  }

  /// The last line on stdout names a PNG that exists.
  void expect_picture(const Finished& finished, const std::filesystem::path& expected) const {
    ASSERT_EQ(finished.exit_code, 0) << finished.err;
    ASSERT_THAT(finished.out, ::testing::EndsWith("\n"));
    const std::string lines = finished.out.substr(0, finished.out.size() - 1);
    const std::filesystem::path last = lines.substr(lines.rfind('\n') + 1);
    EXPECT_EQ(std::filesystem::weakly_canonical(last), std::filesystem::weakly_canonical(expected));
    EXPECT_EQ(read_file(last).substr(0, 8), "\x89PNG\r\n\x1a\n");
    EXPECT_GT(std::filesystem::file_size(last), 10000u);
  }

  TemporaryFolder folder_;
};

TEST_F(Launch, SimulateNodeListenLeavesItsPictureAndNothingElse) {
  expect_picture(launch("simulate_node_listen.sh"), folder_ / "scree_simulated.png");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_.path()), {}), 1) << "temporary files are gone";
}

TEST_F(Launch, ReplayAndListenLeavesThePictureWhereItIsTold) {
  expect_picture(launch("replay_and_listen.sh", {small_recording().string(), "map.png", "--", "--rate", "max"}),
                 folder_ / "map.png");
}

TEST_F(Launch, ServeNodeListenLeavesItsPictureAndNothingElse) {
  const auto finished = launch("serve_node_listen.sh", {"live.png"});
  expect_picture(finished, folder_ / "live.png");
  EXPECT_THAT(finished.err, ::testing::ContainsRegex("frames [1-9][0-9]* mapped [1-9]")) << "the node's last line";
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_.path()), {}), 1) << "temporary files are gone";
}

// Simulator, node and planner over real sockets. The ground is so smooth that a path is always there, and a loaded
// machine, which brings poses late, only makes it slow.
TEST_F(Launch, DriveToGoalArrivesAndLeavesItsPicture) {
  setenv("SCREE_START", "line:-3,0,0,0,1", 1);
  setenv("SCREE_GOAL", "0,1", 1);
  const auto finished =
      launch("drive_to_goal.sh", {"way.png", "--", "--json", "--limit", "200", "--max-pose-age", "20"});
  expect_picture(finished, folder_ / "way.png");
  EXPECT_THAT(finished.out, ::testing::HasSubstr("\"ended\": \"arrived\"")) << finished.err;
  EXPECT_THAT(finished.err, ::testing::HasSubstr("violated_m")) << "the simulator's report";
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_.path()), {}), 1) << "temporary files are gone";
}

TEST_F(Launch, DemoLeavesItsPictureInBuild) {
  expect_picture(launch("demo.sh"), folder_ / "build" / "demo.png");
}

TEST_F(Launch, FailuresKeepTheirExitCodesAndLeaveNoFiles) {
  EXPECT_EQ(launch("replay_and_listen.sh").exit_code, 64);
  EXPECT_EQ(launch("replay_and_listen.sh", {"/nowhere/drive"}).exit_code, 66);
  for (const char* file : {"simulate_node_listen.sh", "serve_node_listen.sh"}) {
    const auto finished = launch(file, {"a.png", "--", "--set", "map.cel_m=1"});
    EXPECT_EQ(finished.exit_code, 78) << finished.err;
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder_.path())) << "nor temporary ones";
}

}  // namespace
}  // namespace scree::test
