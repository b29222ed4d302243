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

TEST(PoseTrack, OfOnePoseHoldsAtItsOwnTimeOnly) {
  const auto track = PoseTrack::make({{at_ms(10), yawed(3.0, 0.0)}});
  ASSERT_TRUE(track);
  EXPECT_DOUBLE_EQ(track->at(at_ms(10))->translation_m.x(), 3.0);
  EXPECT_FALSE(track->at(at_ms(10) - Duration(1)));
  EXPECT_FALSE(track->at(at_ms(10) + Duration(1)));
}

TEST(PoseTrack, FixedHoldsAtEveryTime) {
  Pose pose = yawed(3.0, 0.5);
  pose.rotation.coeffs() *= 0.5;
  const auto track = PoseTrack::fixed(pose);
  for (const int ms : {-5000, 0, 5000}) {
    ASSERT_TRUE(track.at(at_ms(ms)));
    EXPECT_DOUBLE_EQ(track.at(at_ms(ms))->translation_m.x(), 3.0);
    EXPECT_NEAR(track.at(at_ms(ms))->rotation.norm(), 1.0, 1e-15);
    EXPECT_FALSE(track.gap_at(at_ms(ms)));
  }
}

TEST(PoseTrack, DoesNotInterpolateOverAGapBetweenDifferentPoses) {
  const int limit_ms = 1000;
  ASSERT_EQ(PoseTrack::kMaxGap, Duration(std::chrono::milliseconds(limit_ms)));
  for (const Pose& other : {yawed(1.0, 0.0), yawed(0.0, 0.1)}) {
    const auto track =
        PoseTrack::make({{at_ms(0), yawed(0.0, 0.0)}, {at_ms(limit_ms), other}, {at_ms(2 * limit_ms + 1), {}}});
    ASSERT_TRUE(track);
    EXPECT_TRUE(track->at(at_ms(500))) << "the gap may be as long as the limit";
    EXPECT_FALSE(track->at(at_ms(1500)));
    ASSERT_TRUE(track->gap_at(at_ms(1500)));
    EXPECT_EQ(track->gap_at(at_ms(1500))->before, at_ms(1000));
    EXPECT_EQ(track->gap_at(at_ms(1500))->after, at_ms(2001));
    for (const int known_ms : {1000, 2001}) EXPECT_TRUE(track->at(at_ms(known_ms))) << "poses at both ends are known";
  }
}

TEST(PoseTrack, OfABodyThatStandsStillHoldsForAnyTime) {
  Pose opposite = yawed(2.0, 0.3);
  opposite.rotation.coeffs() *= -1.0;  // the same rotation
  const auto track = PoseTrack::make({{at_ms(0), yawed(2.0, 0.3)}, {at_ms(2'000'000), opposite}});
  ASSERT_TRUE(track);
  ASSERT_TRUE(track->at(at_ms(700'000)));
  EXPECT_NEAR(track->at(at_ms(700'000))->translation_m.x(), 2.0, 1e-12);
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
