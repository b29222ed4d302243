// Drive commands, and the robot that obeys them.

#include "drivers/driven_robot.hpp"

#include <cmath>
#include <numbers>

#include "drivers/drive_command.hpp"
#include "drivers/terrain_load.hpp"
#include "tests/drivers/stream_support.hpp"

namespace scree::drivers {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

using DriveBytes = std::array<std::uint8_t, kDriveBytes>;

DriveBytes bytes_of(const DriveCommand& command) {
  DriveBytes bytes{};
  encode_drive(command, bytes);
  return bytes;
}

TEST(DriveCommand, TheseAreTheBytes) {
  const DriveBytes bytes = bytes_of({0x0123456789ABCDEF, 5, 0.75F, -0.5F});
  EXPECT_EQ(stream::Bytes(bytes.begin(), bytes.end()), stream::golden_stream("drive_command"));
  const auto back = decode_drive(bytes);
  ASSERT_TRUE(back);
  EXPECT_EQ(back->boot_id, 0x0123456789ABCDEFu);
  EXPECT_EQ(back->sequence, 5u);
  EXPECT_EQ(back->speed_mps, 0.75F);
  EXPECT_EQ(back->curvature_per_m, -0.5F);
}

TEST(DriveCommand, EveryChangedByteAndEveryOtherLengthIsRefused) {
  const DriveBytes good = bytes_of({1, 2, 0.5F, 0.0F});
  for (std::size_t at = 0; at < good.size(); ++at) {
    DriveBytes bad = good;
    bad[at] ^= 0x40;
    EXPECT_FALSE(decode_drive(bad)) << at;
    EXPECT_FALSE(decode_drive(std::span(good).first(at)));
  }
  for (const float value : {std::nanf(""), 10.5F, -INFINITY}) {
    EXPECT_FALSE(decode_drive(bytes_of({1, 2, value, 0.0F})));
    EXPECT_FALSE(decode_drive(bytes_of({1, 2, 0.0F, value})));
  }
}

TEST(DriveReceiver, CommandsCountInTheirOrderAndAnotherSenderTakesOver) {
  DriveReceiver receiver;
  EXPECT_TRUE(receiver.accept(bytes_of({1, 7, 0.5F, 0.0F})));
  EXPECT_FALSE(receiver.accept(bytes_of({1, 7, 0.5F, 0.0F}))) << "a copy";
  EXPECT_FALSE(receiver.accept(bytes_of({1, 6, 0.5F, 0.0F}))) << "an older one";
  EXPECT_TRUE(receiver.accept(bytes_of({2, 1, 0.5F, 0.0F})));
  EXPECT_EQ(receiver.accepted(), 2u);
  EXPECT_EQ(receiver.rejected(), 2u);
}

class DrivenRobotTest : public ::testing::Test {
 protected:
  DrivenRobot robot(const PlanarPose& start = {}, const OdometryErrors& errors = {}) const {
    auto made = DrivenRobot::make(terrain_, start, TrajectoryConfig{}, errors, 3);
    EXPECT_TRUE(made) << made.error().message;
    return *std::move(made);
  }
  Terrain terrain_ = *load_terrain("fbm:2.3,0.1,7,20,0.1");
};

/// Drives on with a command every 100 ms.
void drive(DrivenRobot& robot, double speed_mps, double curvature_per_m, milliseconds duration) {
  const Time begin = robot.truth().back().time;
  for (milliseconds t{0}; t < duration; t += milliseconds(100)) {
    robot.command(speed_mps, curvature_per_m, begin + t);
    robot.advance_to(begin + t + milliseconds(100));
  }
}

TEST_F(DrivenRobotTest, ItDrivesTheArcThatItIsToldAndStandsOnTheGround) {
  DrivenRobot robot = this->robot();
  drive(robot, 0.5, 0.25, milliseconds(4000));  // 2 m on a circle of 4 m radius: half a radian
  const Pose& pose = robot.truth().back().T_map_body;
  EXPECT_EQ(robot.truth().size(), 401u);
  EXPECT_NEAR(pose.translation_m.x(), 4.0 * std::sin(0.5), 1e-9);
  EXPECT_NEAR(pose.translation_m.y(), 4.0 * (1.0 - std::cos(0.5)), 1e-9);
  const auto expected =
      place_on_terrain({Time{}, pose.translation_m.x(), pose.translation_m.y(), 0.5}, terrain_, TrajectoryConfig{});
  ASSERT_TRUE(expected);
  EXPECT_NEAR(pose.translation_m.z(), expected->translation_m.z(), 1e-9);
  EXPECT_LT(pose.rotation.angularDistance(expected->rotation), 1e-7);
  drive(robot, -0.5, 0.25, milliseconds(4000));  // and back again
  EXPECT_LT(robot.truth().back().T_map_body.translation_m.head<2>().norm(), 1e-9);
}

TEST_F(DrivenRobotTest, WithoutCommandsItStopsAfterHalfASecond) {
  DrivenRobot robot = this->robot();
  robot.command(1.0, 0.0, Time{});
  robot.advance_to(Time(seconds(3)));
  EXPECT_NEAR(robot.truth().back().T_map_body.translation_m.x(), 0.5, 1e-9);
  EXPECT_EQ(robot.timeouts(), 1u);
  EXPECT_EQ(robot.truth().back().time, Time(seconds(3))) << "it stands, and its poses go on";
}

TEST_F(DrivenRobotTest, TheEdgeOfTheTerrainStopsItAndItCanBackOff) {
  DrivenRobot robot = this->robot({Time{}, 8.0, 0.0, 0.0});
  drive(robot, 1.0, 0.0, milliseconds(4000));
  const double x_m = robot.truth().back().T_map_body.translation_m.x();
  EXPECT_GT(x_m, 9.5);
  EXPECT_LT(x_m, 10.0) << "half of the footprint is still on the ground";
  EXPECT_EQ(robot.edge_stops(), 1u);
  drive(robot, -1.0, 0.0, milliseconds(1000));
  EXPECT_NEAR(robot.truth().back().T_map_body.translation_m.x(), x_m - 1.0, 1e-9);
}

TEST_F(DrivenRobotTest, ItsOdometryErrsAsThatOfARecordedDriveDoes) {
  const OdometryErrors errors{0.05, 0.02};
  DrivenRobot robot = this->robot({}, errors);
  drive(robot, 0.5, 0.1, milliseconds(5000));
  const auto truth = PoseTrack::make(robot.truth());
  ASSERT_TRUE(truth);
  const PoseTrack expected = odometry_track(*truth, errors, 3);
  ASSERT_EQ(expected.poses().size(), robot.odometry().size());
  for (std::size_t i = 0; i < robot.odometry().size(); ++i) {
    EXPECT_EQ(robot.odometry()[i].T_map_body.translation_m, expected.poses()[i].T_map_body.translation_m);
    EXPECT_LT(robot.odometry()[i].T_map_body.rotation.angularDistance(expected.poses()[i].T_map_body.rotation), 1e-7);
  }
  EXPECT_GT((robot.odometry().back().T_map_body.translation_m - truth->poses().back().T_map_body.translation_m).norm(),
            0.001);
}

TEST_F(DrivenRobotTest, ALongDriveKeepsItsNewestPosesOnly) {
  DrivenRobot robot = this->robot();
  robot.advance_to(Time(seconds(60)));
  EXPECT_GE(robot.truth().size(), DrivenRobot::kKeptPoses);
  EXPECT_LE(robot.truth().size(), 2 * DrivenRobot::kKeptPoses);
  EXPECT_EQ(robot.truth().back().time, Time(seconds(60)));
  EXPECT_EQ(robot.odometry().size(), robot.truth().size());
}

}  // namespace
}  // namespace scree::drivers
