// The live node: `scree run` with the real binary.

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <signal.h>

#include "tests/integration/hand_made.hpp"
#include "tests/integration/live_node.hpp"

namespace scree::test {
namespace {

using nlohmann::json;
using node::protocol::ByeReason;
using namespace node::protocol;  // the health bits

TEST(Run, SimulatedScannerMapsInRealTimeAsSimUntilSigint) {
  const TemporaryFolder folder;
  write_file(folder / "robot.yaml",
             "source: {kind: simulated, terrain: \"fbm:2.3,0.1,7,30,0.1\", sensor: perceptron-cmu, "
             "trajectory: \"line:-6,0,0,12,1.0\"}\n"
             "publish: {origin: live}\n");  // the simulated device says what it is, whatever the configuration says
  Ear ear;
  const auto begin = MonotonicClock::now();
  Process node(live(folder / "robot.yaml", ear));
  ASSERT_TRUE(ear.until([&] { return ear->frames_in() >= 4 && ear.measured_cells() > 1000; })) << node.err();
  EXPECT_EQ(ear->origin(), drivers::Origin::sim);
  EXPECT_EQ(ear->link(), node::LinkState::fresh);
  EXPECT_GE(MonotonicClock::now() - begin, milliseconds(2000)) << "4 scans of half a second";
  node.signal(SIGINT);
  ASSERT_TRUE(ear.until_bye());
  EXPECT_EQ(ear->bye_reason(), ByeReason::stopped);
  const auto finished = node.wait(seconds(60));
  ASSERT_EQ(finished.exit_code, 0) << finished.err;
  const json statistics = json::parse(finished.out);
  EXPECT_EQ(statistics["frames_in"], statistics["frames_mapped"].get<int>() + statistics["frames_dropped"].get<int>());
  EXPECT_EQ(statistics["cells_measured"], ear.measured_cells()) << "the whole final map is sent before BYE";
}

TEST(Run, StatisticsLineComesOnceASecond) {
  const TemporaryFolder folder;
  const auto recording = make_depth_recording(folder / "drive", every(0.1, 32));
  Ear ear;
  Process node(live(live_config(folder / "robot.yaml", recording), ear));
  const auto finished = node.wait(seconds(120));
  ASSERT_EQ(finished.exit_code, 0) << finished.err;
  // 3.1 s of data: after 1, 2 and 3 s and at the end; a loaded machine may take longer, so the clock counts
  const double elapsed_s = json::parse(finished.out)["elapsed_s"];
  EXPECT_GE(elapsed_s, 3.1);
  EXPECT_NEAR(occurrences(finished.err, "info frames "), std::floor(elapsed_s) + 1.0, 1.0) << finished.err;
}

TEST(Run, NewestFrameWinsWhenMappingIsTooSlowAndDropsAreCounted) {
  const TemporaryFolder folder;
  // 200 frames/s for 2 s into a window of 360 thousand cells; 1 m/s
  const auto recording = make_depth_recording(folder / "drive", every(0.005, 400), 1.0);
  Ear ear;
  Process node(live(live_config(folder / "robot.yaml", recording), ear,
                    {"--set", "map.cell_m=0.02", "--set", "map.size_cells=600"}));
  EXPECT_TRUE(ear.until_health(kHealthOverload, true)) << node.err();
  ASSERT_TRUE(ear.until_bye());
  EXPECT_EQ(ear->bye_reason(), ByeReason::finished);
  const auto finished = node.wait(seconds(120));
  ASSERT_EQ(finished.exit_code, 0) << finished.err;
  const json statistics = json::parse(finished.out);
  EXPECT_EQ(statistics["frames_in"], 400);
  EXPECT_GT(statistics["frames_dropped"], 0);
  EXPECT_EQ(statistics["frames_mapped"].get<int>() + statistics["frames_dropped"].get<int>(), 400);
  EXPECT_EQ(ear->frames_dropped(), statistics["frames_dropped"]);
  EXPECT_EQ(ear->last_valid_map()->data_time.time_since_epoch(), milliseconds(1995)) << "the newest frame is in";
}

TEST(Run, RecordingInALoopGoesOnUntilSigterm) {
  const TemporaryFolder folder;
  const auto recording = make_depth_recording(folder / "drive", every(0.1, 5), 1.0);
  Ear ear;
  Process node(live(live_config(folder / "robot.yaml", recording), ear, {"--set", "source.loop=true"}));
  ASSERT_TRUE(ear.until([&] { return ear->frames_in() > 12; })) << node.err();  // the third time round
  EXPECT_EQ(ear->origin(), drivers::Origin::replay) << "a recording says so, whatever the configuration claims";
  node.signal(SIGTERM);
  ASSERT_TRUE(ear.until_bye());
  EXPECT_EQ(ear->bye_reason(), ByeReason::stopped);
  EXPECT_EQ(node.wait(seconds(60)).exit_code, 0);
}

TEST(Run, SensorThatStallsIsStaleThenLostThenWellAgain) {
  const TemporaryFolder folder;
  auto times_s = every(0.05, 10);
  const auto later = every(0.05, 80, 2.0);  // 1.5 s of silence, then four times what clears the bits
  times_s.insert(times_s.end(), later.begin(), later.end());
  const auto recording = make_depth_recording(folder / "drive", times_s);
  Ear ear;
  Process node(live(live_config(folder / "robot.yaml", recording), ear,
                    {"--set", "node.sensor_stale_ms=300", "--set", "node.sensor_lost_ms=900"}));
  ASSERT_TRUE(ear.until([&] { return ear->frames_in() == 10; })) << node.err();
  ASSERT_TRUE(ear.until_health(kHealthSensorStale, true));
  EXPECT_EQ(ear->health() & kHealthSensorLost, 0);
  ASSERT_TRUE(ear.until_health(kHealthSensorLost, true));
  EXPECT_NE(ear->health() & kHealthSensorStale, 0) << "lost is stale too";
  ASSERT_TRUE(ear.until_health(kHealthSensorStale | kHealthSensorLost, false));
  ASSERT_TRUE(ear.until_bye());
  EXPECT_EQ(ear->health() & kHealthSensorLost, kHealthSensorLost) << "the source has ended: nothing more will come";
  EXPECT_EQ(ear->bye_reason(), ByeReason::finished);
  EXPECT_EQ(node.wait(seconds(60)).exit_code, 0);
}

TEST(Run, WithoutASourceIs78AndWithoutAConfiguration64) {
  const TemporaryFolder folder;
  write_file(folder / "robot.yaml", "map: {cell_m: 0.1}\n");
  const auto finished = scree({"run", "--config", (folder / "robot.yaml").string()});
  EXPECT_EQ(finished.exit_code, 78);
  EXPECT_THAT(finished.err, ::testing::HasSubstr("source.kind: expected recording, simulated, stream, usb or v4l2"));
  EXPECT_EQ(scree({"run"}).exit_code, 64);
}

}  // namespace
}  // namespace scree::test
