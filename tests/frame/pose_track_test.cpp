#include "drivers/frame/pose_track.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>

namespace scree {
namespace {

Pose yawed(double x_m, double yaw_rad) {
  Pose pose;
  pose.translation_m = {x_m, 0.0, 0.0};
  pose.rotation = Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ());
  return pose;
}

Time at_ms(int ms) {
  return Time(std::chrono::milliseconds(ms));
}

TEST(PoseTrack, InterpolatesTranslationAndRotationLinearlyInTime) {
  const auto track = PoseTrack::make({{at_ms(0), yawed(0.0, 0.0)}, {at_ms(100), yawed(2.0, 0.4)}});
  ASSERT_TRUE(track);
  const auto pose = track->at(at_ms(25));
  ASSERT_TRUE(pose);
  EXPECT_NEAR(pose->translation_m.x(), 0.5, 1e-12);
  EXPECT_NEAR(Eigen::AngleAxisd(pose->rotation).angle(), 0.1, 1e-12);
}

TEST(PoseTrack, TakesTheShortWayRoundForOppositeSigns) {
  auto second = yawed(0.0, 0.2);
  second.rotation.coeffs() *= -1.0;  // the same rotation
  const auto track = PoseTrack::make({{at_ms(0), yawed(0.0, 0.0)}, {at_ms(10), second}});
  ASSERT_TRUE(track);
  EXPECT_NEAR(track->at(at_ms(5))->rotation.angularDistance(yawed(0.0, 0.1).rotation), 0.0, 1e-7);
}

TEST(PoseTrack, CoversItsEndsAndNothingBeyond) {
  const auto track = PoseTrack::make({{at_ms(10), yawed(0.0, 0.0)}, {at_ms(20), yawed(1.0, 0.0)}});
  ASSERT_TRUE(track);
  EXPECT_DOUBLE_EQ(track->at(at_ms(10))->translation_m.x(), 0.0);
  EXPECT_DOUBLE_EQ(track->at(at_ms(20))->translation_m.x(), 1.0);
  EXPECT_FALSE(track->at(at_ms(9)));
  EXPECT_FALSE(track->at(at_ms(21)));
}

TEST(PoseTrack, OfOnePoseHoldsAtEveryTime) {
  const auto track = PoseTrack::make({{at_ms(10), yawed(3.0, 0.0)}});
  ASSERT_TRUE(track);
  EXPECT_DOUBLE_EQ(track->at(at_ms(-5000))->translation_m.x(), 3.0);
}

TEST(PoseTrack, NormalisesNearlyUnitQuaternions) {
  Pose pose;
  pose.rotation.coeffs() *= 1.0005;
  const auto track = PoseTrack::make({{at_ms(0), pose}});
  ASSERT_TRUE(track);
  EXPECT_NEAR(track->poses().front().T_map_body.rotation.norm(), 1.0, 1e-15);
}

TEST(PoseTrack, NamesThePoseItRefuses) {
  Pose nan;
  nan.translation_m.y() = std::numeric_limits<double>::quiet_NaN();
  Pose long_quaternion;
  long_quaternion.rotation.coeffs() *= 1.01;
  const auto message = [](std::vector<StampedPose> poses) {
    const auto track = PoseTrack::make(std::move(poses));
    return track ? std::string("accepted") : track.error().message;
  };
  EXPECT_NE(message({}).find("none"), std::string::npos);
  EXPECT_NE(message({{at_ms(0), {}}, {at_ms(1), nan}}).find("pose 1: expected finite"), std::string::npos);
  EXPECT_NE(message({{at_ms(0), long_quaternion}}).find("norm 1.01"), std::string::npos);
  EXPECT_NE(message({{at_ms(5), {}}, {at_ms(5), {}}}).find("pose 1: expected a time after 0.005 s"), std::string::npos);
}

}  // namespace
}  // namespace scree
