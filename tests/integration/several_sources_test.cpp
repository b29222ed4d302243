// A node with several sources: one that is dead, wrong or gone degrades it and does not stop the others.

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <optional>
#include <signal.h>

#include "tests/integration/hand_made.hpp"
#include "tests/integration/live_node.hpp"

namespace scree::test {
namespace {

using nlohmann::json;
using namespace node::protocol;  // the health bits

class SeveralSources : public ::testing::Test {
 protected:
  std::string socket(const std::string& name) const { return "unix:" + (folder_ / name).string(); }
  std::vector<std::string> device(const std::string& sensor, const std::string& name) const {
    return command({"simulate", "--terrain", "fbm:2.3,0.1,7,20,0.1", "--sensor", sensor, "--trajectory",
                    "line:-5,0,0,2,0.5", "--frame-period", "0.5", "--drive", "127.0.0.1:0", "--serve", socket(name)});
  }
  std::filesystem::path config(const std::string& second) const {
    write_file(folder_ / "robot.yaml", "sources:\n  - {name: front, kind: stream, address: \"" + socket("front") +
                                           "\", deadline_ms: 60000}\n  - " + second +
                                           "\npose: {source: static, T_map_body: {x_m: -5}}\n" +
                                           "node: {sensor_stale_ms: 3000, sensor_lost_ms: 6000}\n");
    return folder_ / "robot.yaml";
  }
  bool until_sensor(std::size_t i, SensorState state) {
    return ear_.until([&] {
      const auto beat = ear_->heartbeat();
      return beat && beat->sensor_count > i && beat->sensors[i].state == state;
    });
  }
  json stop(Process& node) {
    node.signal(SIGINT);
    EXPECT_TRUE(ear_.until_bye());
    const auto finished = node.wait(seconds(60));
    EXPECT_EQ(finished.exit_code, 0) << finished.err;
    return json::parse(finished.out, nullptr, false);
  }

  TemporaryFolder folder_;
  Ear ear_;
};

TEST_F(SeveralSources, ADeadOneIsToldTheOtherGoesOnAndItComesBack) {
  Process front(device("lidar64", "front"));
  std::optional<Process> low(std::in_place, device("depth-small", "low"));
  Process node(live(config("{name: low, kind: stream, address: \"" + socket("low") + "\", deadline_ms: 60000}"), ear_));
  ASSERT_TRUE(until_sensor(0, SensorState::ok)) << node.err();
  ASSERT_TRUE(until_sensor(1, SensorState::ok)) << node.err();
  low->signal(SIGKILL);
  low->wait();
  ASSERT_TRUE(until_sensor(1, SensorState::lost)) << node.err();
  EXPECT_TRUE(ear_.until_health(kHealthSensorLost, true));
  const std::uint64_t frames = ear_->frames_in();
  EXPECT_TRUE(ear_.until([&] { return ear_->frames_in() >= frames + 3; })) << "the other delivers on";
  EXPECT_TRUE(until_sensor(0, SensorState::ok));
  low.emplace(device("depth-small", "low"));
  EXPECT_TRUE(until_sensor(1, SensorState::ok)) << node.err();
  EXPECT_TRUE(ear_.until_health(kHealthSensorLost, false));
  const json statistics = stop(node);
  EXPECT_EQ(statistics["sources"][1]["counters"]["connections"], 2);
  EXPECT_THAT(node.err(), ::testing::HasSubstr("source low: lost"));
}

TEST_F(SeveralSources, OneOfAnotherGeometryThanConfiguredIsTriedAgainWhileTheOtherMaps) {
  Process front(device("lidar64", "front"));
  Process low(device("depth-small", "low"));
  Process node(live(config("{name: low, kind: stream, address: \"" + socket("low") +
                           "\", sensor: {projection: pinhole, parameters: {fx_px: 1, fy_px: 1}}}"),
                    ear_));
  ASSERT_TRUE(until_sensor(0, SensorState::ok)) << node.err();
  ASSERT_TRUE(node.wait_for_text("trying again")) << node.err();
  const std::uint64_t frames = ear_->frames_in();
  EXPECT_TRUE(ear_.until([&] { return ear_->frames_in() >= frames + 3; }));
  const json statistics = stop(node);
  EXPECT_GE(statistics["sources"][1]["failures"], 1);
  EXPECT_EQ(statistics["sources"][1]["frames_mapped"], 0);
  EXPECT_GE(statistics["sources"][0]["frames_mapped"], 3);
  EXPECT_THAT(node.err(), ::testing::HasSubstr("source low: stream unix:"));
}

TEST_F(SeveralSources, ACameraNeedsPosesAndIntrinsicsFromTheConfiguration) {
  const auto without_sensor = run(live(config("{kind: v4l2, device: /dev/none}"), ear_));
  EXPECT_EQ(without_sensor.exit_code, 78);
  EXPECT_THAT(without_sensor.err, ::testing::HasSubstr("expected a sensor with projection pinhole"));
  const auto without_pose = run(live(config("{kind: v4l2, device: /dev/none, sensor: {projection: pinhole, parameters: "
                                            "{fx_px: 9, fy_px: 9, cx_px: 4, cy_px: 4}}}"),
                                     ear_, {"--set", "pose.source=recording"}));
  EXPECT_EQ(without_pose.exit_code, 78);
  EXPECT_THAT(without_pose.err, ::testing::HasSubstr("expected pose.source udp or static with kind v4l2"));
}

TEST_F(SeveralSources, DevicesThatAreNotThereAreWaitedFor) {
  Process front(device("lidar64", "front"));
  Process node(live(config("{name: low, kind: v4l2, device: /dev/none, sensor: {projection: pinhole, parameters: "
                           "{fx_px: 9, fy_px: 9, cx_px: 4, cy_px: 4}}}"),
                    ear_));
  ASSERT_TRUE(until_sensor(0, SensorState::ok)) << node.err();
  EXPECT_TRUE(until_sensor(1, SensorState::waiting));
  const json statistics = stop(node);
  EXPECT_EQ(statistics["sources"][1]["frames_in"], 0);
  EXPECT_THAT(node.err(), ::testing::HasSubstr("/dev/none"));
}

}  // namespace
}  // namespace scree::test
