// What a vehicle meets on ground whose shape is known.

#include "node/ground_limits.hpp"

#include <cmath>
#include <functional>
#include <gtest/gtest.h>

#include "node/robot_way.hpp"

namespace scree::node {
namespace {

/// 20 m × 20 m around the origin, nodes every 5 cm.
drivers::Terrain terrain(const std::function<double(double x_m, double y_m)>& height_m) {
  io::Raster raster;
  constexpr int kSide = 401;
  raster.cell_m = raster.cell_y_m = 0.05;
  raster.x_min_m = raster.y_min_m = -10.025;
  raster.height_m.assign(kSide, kSide, 0.0F);
  for (int r = 0; r < kSide; ++r)
    for (int c = 0; c < kSide; ++c)
      raster.height_m(r, c) = static_cast<float>(height_m(-10.0 + 0.05 * c, -10.0 + 0.05 * r));
  auto made = drivers::Terrain::make(std::move(raster), "test");
  EXPECT_TRUE(made) << made.error().message;
  return *std::move(made);
}

Pose at(double x_m, double y_m, double heading_rad = 0.0) {
  return {{x_m, y_m, 0.0}, Eigen::Quaterniond(Eigen::AngleAxisd(heading_rad, Eigen::Vector3d::UnitZ()))};
}

const mapping::VehicleConfig kVehicle;

TEST(GroundLimits, APlaneGivesItsSlopeAsPitchAndRoll) {
  const auto ground = terrain([](double x, double y) { return 0.2 * x + 0.1 * y; });
  GroundLimits limits(ground, kVehicle);
  limits.add(at(1.0, 2.0, 0.0175));  // the middle of the sector of 2° around 1°
  // along: 0.2·cos + 0.1·sin, across: 0.1·cos − 0.2·sin of a heading within 1°
  EXPECT_NEAR(limits.met().pitch_rad, std::atan(0.2), 0.1 * 0.035);
  EXPECT_NEAR(limits.met().roll_rad, std::atan(0.1), 0.2 * 0.035);
  EXPECT_NEAR(limits.met().belly_m, 0.0, 1e-6);
  // the steepest change within a wheel radius of a plane: the slope times the farthest point of the disc
  EXPECT_LE(limits.met().step_m, std::hypot(0.2, 0.1) * kVehicle.wheel_radius_m + 1e-6);
  EXPECT_GE(limits.met().step_m, 0.2 * kVehicle.wheel_radius_m - 1e-6);
  EXPECT_EQ(limits.violated_m(), 0.0);
  GroundLimits across(ground, kVehicle);
  across.add(at(1.0, 2.0, 0.0175 + M_PI_2));
  EXPECT_NEAR(across.met().pitch_rad, std::atan(0.1), 0.2 * 0.035);
  EXPECT_NEAR(across.met().roll_rad, std::atan(0.2), 0.1 * 0.035);
}

TEST(GroundLimits, AStepCountsWhereAWheelMeetsItAndTheWayOverItIsViolated) {
  const auto ground = terrain([](double x, double) { return x > 3.0 ? 0.2 : 0.0; });
  GroundLimits limits(ground, kVehicle);  // wheels at ± 0.3 m
  for (int i = 0; i <= 500; ++i) limits.add(at(0.01 * i, 0.0));
  EXPECT_NEAR(limits.met().step_m, 0.2, 1e-6);
  EXPECT_NEAR(limits.path_m(), 5.0, 1e-9);
  // more than 0.12 m of the step is met by the front wheels from x = 2.6 … 2.85 on and by the rear wheels till 3.45:
  // a wheel's radius before and behind the edge, and the belly or the pitch between
  EXPECT_GT(limits.violated_m(), 0.4);
  EXPECT_LT(limits.violated_m(), 1.1);
  GroundLimits before(ground, kVehicle);
  for (int i = 0; i <= 200; ++i) before.add(at(0.01 * i, 0.0));
  EXPECT_EQ(before.met().step_m, 0.0);
  EXPECT_EQ(before.violated_m(), 0.0);
}

TEST(GroundLimits, ABumpBetweenTheWheelsIsMetByTheBelly) {
  const auto ground = terrain([](double x, double y) { return std::hypot(x, y) < 0.06 ? 0.3 : 0.0; });
  GroundLimits limits(ground, kVehicle);
  limits.add(at(0.0, 0.0));
  EXPECT_NEAR(limits.met().belly_m, 0.3, 1e-6);
  EXPECT_EQ(limits.met().step_m, 0.0);
}

TEST(GroundLimits, GroundThatIsNotThereIsCountedAndNotJudged) {
  const auto ground = terrain([](double, double) { return 0.0; });
  GroundLimits limits(ground, kVehicle);
  limits.add(at(9.95, 0.0));
  EXPECT_EQ(limits.judged(), 1u);
  EXPECT_EQ(limits.without_ground(), 1u);
}

TEST(RobotWay, PosesAroundAFrameReachOverBothEndsAndNoFarther) {
  using std::chrono::milliseconds;
  std::vector<StampedPose> track;
  for (int i = 0; i < 10; ++i) track.push_back({Time(milliseconds(10 * i)), {}});
  const auto times = [&](int begin_ms, int end_ms) {
    std::vector<std::int64_t> out;
    for (const StampedPose& pose : poses_around(track, Time(milliseconds(begin_ms)), Time(milliseconds(end_ms))))
      out.push_back(pose.time.time_since_epoch() / milliseconds(1));
    return out;
  };
  EXPECT_EQ(times(25, 41), (std::vector<std::int64_t>{20, 30, 40, 50}));
  EXPECT_EQ(times(20, 40), (std::vector<std::int64_t>{20, 30, 40}));
  EXPECT_EQ(times(30, 30), (std::vector<std::int64_t>{30}));
  EXPECT_EQ(times(85, 90), (std::vector<std::int64_t>{80, 90}));
}

}  // namespace
}  // namespace scree::node
