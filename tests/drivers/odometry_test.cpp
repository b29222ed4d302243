#include "drivers/odometry.hpp"

#include <cmath>
#include <fstream>
#include <gtest/gtest.h>

#include "drivers/table.hpp"
#include "io/file_bytes.hpp"
#include "tests/drivers/simulator_support.hpp"

namespace scree::drivers {
namespace {

/// 1 m/s along x, a pose every 50 ms.
PoseTrack straight(double length_m) {
  std::vector<StampedPose> poses;
  for (int i = 0; i <= static_cast<int>(20.0 * length_m); ++i)
    poses.push_back({Time(std::chrono::milliseconds(50 * i)), {{0.05 * i, 0.0, 0.0}, Eigen::Quaterniond::Identity()}});
  return *PoseTrack::make(std::move(poses));
}

double angle_rad(const Eigen::Quaterniond& rotation) {
  return Eigen::Quaterniond::Identity().angularDistance(rotation);
}

TEST(Odometry, WithoutErrorsIsTheTruth) {
  const auto truth = straight(1.0);
  const auto track = odometry_track(truth, {}, 1);
  ASSERT_EQ(track.poses().size(), truth.poses().size());
  EXPECT_EQ(track.poses().back().T_map_body.translation_m, truth.poses().back().T_map_body.translation_m);
}

// 400 seeds: the relative standard error of a mean square of normals is √(2/400) = 7 %, so 30 % is beyond 4 sigma
// (false alarms below 1e-4 each, six checks). 20 m of way: variance share ½ + ½·2(4 − 1 + e⁻⁴)/16 = 0.689.
TEST(Odometry, DriftIsTheShareOfTheWayInEachDirection) {
  const auto truth = straight(20.0);
  Eigen::Array3d near = Eigen::Array3d::Zero(), far = Eigen::Array3d::Zero();
  constexpr int kSeeds = 400;
  for (int seed = 0; seed < kSeeds; ++seed) {
    const auto track = odometry_track(truth, {0.01, 0.0}, static_cast<std::uint64_t>(seed));
    EXPECT_EQ(track.poses().front().T_map_body.translation_m, Eigen::Vector3d::Zero());
    near +=
        (track.at(Time(std::chrono::milliseconds(500)))->translation_m - Eigen::Vector3d(0.5, 0, 0)).array().square();
    far += (track.poses().back().T_map_body.translation_m - Eigen::Vector3d(20, 0, 0)).array().square();
  }
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(near[axis] / kSeeds, 0.005 * 0.005 * 0.983, 0.3 * 0.005 * 0.005);
    EXPECT_NEAR(far[axis] / kSeeds, 0.2 * 0.2 * 0.689, 0.3 * 0.2 * 0.2);
  }
}

// As above; four sines with random phases scatter less than a normal does.
TEST(Odometry, AttitudeErrsByItsRmsAboutEachAxisAndSlowly) {
  const auto truth = straight(2.0);
  double square = 0.0, change = 0.0;
  constexpr int kSeeds = 400;
  for (int seed = 0; seed < kSeeds; ++seed) {
    const auto track = odometry_track(truth, {0.0, 0.02}, static_cast<std::uint64_t>(seed));
    const auto first = track.poses().front().T_map_body.rotation;
    square += std::pow(angle_rad(first), 2);
    change += std::pow(first.angularDistance(track.at(Time(std::chrono::milliseconds(100)))->rotation), 2);
  }
  EXPECT_NEAR(square / kSeeds, 3 * 0.02 * 0.02, 0.3 * 3 * 0.02 * 0.02);
  // the fastest sine has 8 s: within 0.1 s it changes by at most 2π/80 of its amplitude
  EXPECT_LT(std::sqrt(change / kSeeds), 0.08 * 0.02 * std::sqrt(3.0));
}

TEST(Odometry, ARobotThatStandsDoesNotDriftAndItsTrackHasNoGap) {
  const Pose place{{3, 4, 5}, Eigen::Quaterniond::Identity()};
  const auto truth = *PoseTrack::make({{Time{}, place}, {Time(std::chrono::seconds(30)), place}});
  const auto track = odometry_track(truth, {0.05, 0.02}, 3);
  EXPECT_EQ(track.poses().back().T_map_body.translation_m, place.translation_m);
  EXPECT_GT(track.poses().back().T_map_body.rotation.angularDistance(place.rotation), 0.0);
  for (int t = 0; t <= 300; ++t) EXPECT_TRUE(track.at(Time(std::chrono::milliseconds(100 * t)))) << t;
}

TEST(Odometry, RangesLeaveTheTruePosesAndRecordingsHoldBoth) {
  auto config = small_drive("perceptron-cmu", false);
  const auto exact = made(config);
  config.odometry = {0.03, 0.02};
  const auto drifting = made(config);
  SerialExecutor serial;
  const auto frame = drifting.render(2, serial);
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->raw, exact.render(2, serial)->raw);
  const auto delivered = drifting.range_frame(*frame, Duration{0});
  EXPECT_EQ(delivered->T_map_body[0].translation_m, drifting.odometry().at(frame->time)->translation_m);
  EXPECT_NE(delivered->T_map_body[0].translation_m, drifting.poses().at(frame->time)->translation_m);

  const auto folder = scratch("odometry");
  ASSERT_TRUE(write_recording(drifting, folder, "scree_recording: 1\n", serial));
  const auto read = [&](const char* file) {
    std::vector<std::uint8_t> bytes;
    EXPECT_TRUE(io::read_bytes(folder / file, kTableMaxBytes, bytes));
    return *parse_poses_table(io::as_text(bytes), file);
  };
  EXPECT_EQ(read("truth/poses.csv").back().T_map_body.translation_m,
            drifting.poses().poses().back().T_map_body.translation_m);
  EXPECT_EQ(read("poses.csv").back().T_map_body.translation_m,
            drifting.odometry().poses().back().T_map_body.translation_m);
}

TEST(Odometry, RefusesErrorsThatAreNone) {
  auto config = small_drive("perceptron-cmu", false);
  config.odometry.drift_share = -0.1;
  const auto made_of_it = Simulator::make(config);
  ASSERT_FALSE(made_of_it);
  EXPECT_EQ(made_of_it.error().kind, ErrorKind::usage);
}

}  // namespace
}  // namespace scree::drivers
