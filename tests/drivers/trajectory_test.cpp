#include "drivers/trajectory.hpp"

#include <cmath>
#include <fstream>
#include <functional>
#include <gtest/gtest.h>
#include <numbers>

#include "tests/drivers/simulator_support.hpp"

namespace scree::drivers {
namespace {

using Eigen::Vector3d;
constexpr double kDegree = std::numbers::pi / 180.0;

Terrain make_terrain(const std::function<double(double x, double y)>& height) {
  io::Raster raster;
  raster.cell_m = raster.cell_y_m = 0.25;
  raster.x_min_m = raster.y_min_m = -10.125;
  raster.height_m.assign(81, 81, 0.0F);
  for (int r = 0; r < 81; ++r)
    for (int c = 0; c < 81; ++c) raster.height_m(r, c) = static_cast<float>(height((c - 40) * 0.25, (r - 40) * 0.25));
  auto terrain = Terrain::make(std::move(raster), "test");
  EXPECT_TRUE(terrain);
  return *std::move(terrain);
}

Terrain tilted() {
  return make_terrain([](double x, double y) { return 0.25 * x - 0.125 * y + 2.0; });
}

Time at(double seconds) {
  return Time(from_seconds(seconds));
}

std::string write_csv(const std::string& name, const std::string& text) {
  const auto file = scratch(name);
  std::ofstream(file) << text;
  return file.string();
}

TEST(Trajectory, LineOnAPlaneLiesOnItAndPointsUphill) {
  const auto terrain = tilted();
  const auto drive = make_trajectory("line:-2,1,30,4,2", terrain, {});
  ASSERT_TRUE(drive) << drive.error().message;
  EXPECT_EQ(drive->drive, from_seconds(2.0));
  for (const double t : {0.0, 0.4237, 1.0, 2.0}) {
    const auto pose = drive->track.at(at(t));
    ASSERT_TRUE(pose);
    const double x = -2.0 + 2.0 * t * std::cos(30 * kDegree), y = 1.0 + 2.0 * t * std::sin(30 * kDegree);
    EXPECT_NEAR((pose->translation_m - Vector3d(x, y, 0.25 * x - 0.125 * y + 2.0)).norm(), 0.0, 1e-9) << t;
    const Vector3d up = pose->rotation * Vector3d::UnitZ(), forward = pose->rotation * Vector3d::UnitX();
    EXPECT_NEAR((up - Vector3d(-0.25, 0.125, 1.0).normalized()).norm(), 0.0, 1e-9);
    EXPECT_NEAR(std::atan2(forward.y(), forward.x()), 30 * kDegree, 1e-9);
    EXPECT_NEAR(forward.z(), forward.head<2>().dot(Eigen::Vector2d(0.25, -0.125)), 1e-9);
  }
  EXPECT_FALSE(drive->track.at(at(2.001)));
}

TEST(Trajectory, GravityAlignedBodyStaysUpright) {
  TrajectoryConfig config;
  config.placement = BodyPlacement::gravity_aligned;
  const auto drive = make_trajectory("line:0,0,-90,1,1", tilted(), config);
  ASSERT_TRUE(drive);
  const auto pose = drive->track.at(at(0.5));
  ASSERT_TRUE(pose);
  EXPECT_NEAR((pose->rotation * Vector3d::UnitZ() - Vector3d::UnitZ()).norm(), 0.0, 1e-12);
  EXPECT_NEAR((pose->rotation * Vector3d::UnitX() + Vector3d::UnitY()).norm(), 0.0, 1e-12);
}

TEST(Trajectory, ArcsTurnAboutTheirCentre) {
  const auto terrain = make_terrain([](double, double) { return 0.0; });
  // Heading east: the centre of a left arc is north, of a right one south.
  const auto left = make_trajectory("arc:1,2,0,3,90,1.5", terrain, {});
  const auto right = make_trajectory("arc:1,2,0,3,-90,1.5", terrain, {});
  ASSERT_TRUE(left && right);
  EXPECT_EQ(left->drive, from_seconds(std::numbers::pi));  // 3 m · π/2 at 1.5 m/s
  EXPECT_NEAR((left->track.poses().back().T_map_body.translation_m - Vector3d(4, 5, 0)).norm(), 0.0, 1e-9);
  EXPECT_NEAR((right->track.poses().back().T_map_body.translation_m - Vector3d(4, -1, 0)).norm(), 0.0, 1e-9);
  for (const auto& stamped : left->track.poses())
    EXPECT_NEAR((stamped.T_map_body.translation_m - Vector3d(1, 5, 0)).norm(), 3.0, 1e-9);
  const Vector3d forward = left->track.poses().back().T_map_body.rotation * Vector3d::UnitX();
  EXPECT_NEAR((forward - Vector3d::UnitY()).norm(), 0.0, 1e-9);
}

TEST(Trajectory, HoldKeepsTheLastPose) {
  TrajectoryConfig config;
  config.hold = from_seconds(0.5);
  const auto drive = make_trajectory("line:0,0,0,1,1", tilted(), config);
  ASSERT_TRUE(drive);
  EXPECT_EQ(drive->drive, from_seconds(1.0));
  const auto end = drive->track.at(at(1.0)), later = drive->track.at(at(1.5));
  ASSERT_TRUE(end && later);
  EXPECT_EQ(end->translation_m, later->translation_m);
}

TEST(Trajectory, StandingStillIsOnePoseForEver) {
  const auto drive = make_trajectory("line:0,0,45,0,1", tilted(), {});
  ASSERT_TRUE(drive) << drive.error().message;
  EXPECT_EQ(drive->drive, Duration{0});
  EXPECT_EQ(drive->track.poses().size(), 1U);
}

TEST(Trajectory, FileOfPlacesIsPutOntoTheTerrainTheShortWayRound) {
  const auto file = write_csv("way.csv", "t_s,x_m,y_m,heading_deg\n10,0,0,170\n11,1,-1,-170\n");
  const auto drive = make_trajectory(file, tilted(), {});
  ASSERT_TRUE(drive) << drive.error().message;
  EXPECT_EQ(drive->track.begin(), at(10));
  const auto pose = drive->track.at(at(10.5));
  ASSERT_TRUE(pose);
  EXPECT_NEAR((pose->translation_m - Vector3d(0.5, -0.5, 0.125 + 0.0625 + 2.0)).norm(), 0.0, 1e-9);
  const Vector3d forward = pose->rotation * Vector3d::UnitX();
  EXPECT_LT(forward.x(), -0.9);  // 180°, not 0°
}

TEST(Trajectory, FileOfPosesIsTakenAsItIs) {
  const auto file = write_csv("poses.csv", "t_s,x_m,y_m,z_m,qx,qy,qz,qw\n0,1,2,3,0,0,0,1\n1,1,2,5,0,0,0,1\n");
  const auto drive = make_trajectory(file, tilted(), {});
  ASSERT_TRUE(drive) << drive.error().message;
  const auto pose = drive->track.at(at(0.25));
  ASSERT_TRUE(pose);
  EXPECT_EQ(pose->translation_m, Vector3d(1, 2, 3.5));
}

void expect_error(const std::string& specification, ErrorKind kind, const std::string& text) {
  const auto drive = make_trajectory(specification, tilted(), {});
  ASSERT_FALSE(drive) << specification;
  EXPECT_EQ(drive.error().kind, kind) << drive.error().message;
  EXPECT_NE(drive.error().message.find(text), std::string::npos) << drive.error().message;
}

TEST(Trajectory, FileOfPosesWithAGapIsRefused) {
  const auto file = write_csv("gap.csv", "t_s,x_m,y_m,z_m,qx,qy,qz,qw\n0,1,2,3,0,0,0,1\n1.5,1,2,5,0,0,0,1\n");
  expect_error(file, ErrorKind::bad_data, "expected different poses at most 1 s apart, found 0 and 1.5 s");
}

TEST(Trajectory, UsageErrorsNameTheGrammar) {
  expect_error("line:0,0,0,1", ErrorKind::usage, "line:X0,Y0,HEADING_DEG,LENGTH_M,SPEED_MPS");
  expect_error("line:0,0,0,1,x", ErrorKind::usage, "'x' is not a finite number");
  expect_error("line:0,0,0,1,nan", ErrorKind::usage, "finite");
  expect_error("line:0,0,0,1,0", ErrorKind::usage, "SPEED_MPS must be positive");
  expect_error("line:0,0,0,-1,1", ErrorKind::usage, "LENGTH_M");
  expect_error("line:0,0,0,1e12,1e-3", ErrorKind::usage, "too long");
  expect_error("arc:0,0,0,-1,90,1", ErrorKind::usage, "RADIUS_M");
  expect_error("arc:0,0,0,1,90", ErrorKind::usage, "arc:X0,Y0,HEADING_DEG,RADIUS_M,ANGLE_DEG,SPEED_MPS");
  expect_error("circle:1", ErrorKind::usage, "neither line:, arc: nor a .csv file");
  expect_error("", ErrorKind::usage, "FILE.csv");
}

TEST(Trajectory, LeavingTheTerrainNamesThePlaceAndTheExtent) {
  expect_error("line:8,0,0,4,1", ErrorKind::usage, "x -10 … 10 m, y -10 … 10 m");
  expect_error("line:100,0,0,1,1", ErrorKind::usage, "x 100, y 0");
}

TEST(Trajectory, BadFilesAreNamedWithTheirLine) {
  expect_error("/nonexistent/way.csv", ErrorKind::no_input, "/nonexistent/way.csv");
  expect_error(write_csv("a.csv", "time,x\n1,2\n"), ErrorKind::bad_data, "a.csv:1");
  expect_error(write_csv("b.csv", "t_s,x_m,y_m,heading_deg\n0,0,0,0\n0,1,0,0\n"), ErrorKind::bad_data, "b.csv:3");
  expect_error(write_csv("c.csv", "t_s,x_m,y_m,heading_deg\n0,nan,0,0\n"), ErrorKind::bad_data, "c.csv:2");
  expect_error(write_csv("d.csv", "t_s,x_m,y_m,heading_deg\n"), ErrorKind::bad_data, "d.csv");
}

}  // namespace
}  // namespace scree::drivers
