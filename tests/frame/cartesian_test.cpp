// Points land where the scene is: planes standing and driving, every pixel accounted for.

#include <gtest/gtest.h>
#include <numeric>

#include "tests/frame/scanned_scene.hpp"

namespace scree {
namespace {

using namespace test;

const Scene kGround = plane({0, 0, 0}, {0, 0, 1});

PoseTrack driving_and_turning() {
  std::vector<StampedPose> poses;
  for (int i = 0; i <= 10; ++i) {
    Pose pose;
    pose.translation_m = {500.0 + 0.15 * i, -200.0 + 0.01 * i * i, 0.02 * i};
    pose.rotation =
        Eigen::AngleAxisd(0.06 * i, Eigen::Vector3d::UnitZ()) * Eigen::AngleAxisd(0.01 * i, Eigen::Vector3d::UnitX());
    poses.push_back({Time(std::chrono::milliseconds(60 * i)), pose});
  }
  return *PoseTrack::make(std::move(poses));
}

/// Largest |z| that rounding leaves: a count's half step along the ray, and float arithmetic (u = 2^-24) on numbers up
/// to the range plus the sensor's offset, fewer than 16 roundings.
double height_bound_m(const Projection& p, double range_m, double direction_z, bool quantised) {
  const double quantum = quantised ? 0.5 * p.range_per_count_m[0] * std::abs(direction_z) : 0.0;
  return quantum * (1.0 + 1e-4) + 16.0 * 0x1p-24 * (range_m + 5.0);
}

void expect_flat(const Projection& p, const PointFrame& points, bool quantised) {
  ASSERT_GT(points.size(), 1000U);
  for (std::size_t i = 0; i < points.size(); ++i)
    ASSERT_LE(std::abs(map_point(points, i).z()),
              height_bound_m(p, points.range_m[i], points.direction_z[i], quantised));
}

TEST(PointConverter, DrivingAndTurningDoesNotBendThePlane) {
  const auto projection = unambiguous_perceptron(128, 96);
  SensorConfig sensor;
  sensor.T_body_sensor = perceptron_mount(1.6, 0.6, 0.3);
  sensor.row_period = std::chrono::milliseconds(4);
  sensor.filter = no_filter();
  SerialExecutor executor;
  PointFrame points;
  for (const bool quantise : {false, true}) {
    const auto moving = scan(projection, sensor, driving_and_turning(), kGround, 0.0, quantise);
    ASSERT_TRUE(PointConverter().convert(moving.frame, {}, executor, points));
    EXPECT_EQ(points.size(), 128U * 96U);
    expect_flat(*projection, points, quantise);
  }
  // The same frame with one pose for all rows shows what this guards against.
  auto bent = scan(projection, sensor, driving_and_turning(), kGround).frame;
  for (auto& pose : bent.T_map_body) pose = bent.T_map_body.back();
  ASSERT_TRUE(PointConverter().convert(bent, {}, executor, points));
  double worst = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) worst = std::max(worst, std::abs(map_point(points, i).z()));
  EXPECT_GT(worst, 0.1);
}

TEST(PointConverter, DepthImageOfAPlaneIsFlat) {
  const auto projection = projection_of(ProjectionKind::pinhole, 120, 160);
  SensorConfig sensor;
  Eigen::Matrix3d axes;  // x right, y down, z forward
  axes << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  sensor.T_body_sensor.rotation = Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitY()) * Eigen::Quaterniond(axes);
  sensor.T_body_sensor.translation_m = {0.1, 0.0, 1.2};
  sensor.filter = no_filter();
  const auto frame = scan(projection, sensor, standing(), kGround).frame;
  SerialExecutor executor;
  PointFrame points;
  ASSERT_TRUE(PointConverter().convert(frame, {}, executor, points));
  for (std::size_t i = 0; i < points.size(); ++i)  // a count is 1 mm of depth, at most 1.5 mm along the ray
    ASSERT_LE(std::abs(map_point(points, i).z()), 0.00075 + 1e-5);
}

TEST(PointConverter, AnchorIsWholeMetresAndKeepsFloatsSmall) {
  const auto projection = unambiguous_perceptron(32, 32);
  SensorConfig sensor;
  sensor.T_body_sensor = perceptron_mount(1.6, 0.6);
  sensor.filter = no_filter();
  Pose far_away;
  far_away.translation_m = {4'321'987.4, -765'432.6, 0.0};
  const auto frame = scan(projection, sensor, standing(far_away), kGround, 0.0, false).frame;
  SerialExecutor executor;
  PointFrame points;
  ASSERT_TRUE(PointConverter().convert(frame, {}, executor, points));
  EXPECT_EQ(points.anchor_map_m, Eigen::Vector3d(4'321'987.0, -765'433.0, 0.0));
  EXPECT_NEAR((points.anchor_map_m + points.sensor_m[0].cast<double>() - far_away.translation_m).head<2>().norm(), 0.0,
              1e-6);
  for (std::size_t i = 0; i < points.size(); ++i) ASSERT_LE(std::abs(map_point(points, i).z()), 1e-5);
}

TEST(PointConverter, VarianceFollowsTheSensorModel) {
  const auto projection = unambiguous_perceptron(16, 16);
  SensorConfig sensor;
  sensor.T_body_sensor = perceptron_mount(1.6, 0.8);
  sensor.noise = {0.01, 0.002, 0.0003};
  sensor.filter = no_filter();
  const auto frame = scan(projection, sensor, standing(), kGround).frame;
  SerialExecutor executor;
  PointFrame points;
  ASSERT_TRUE(PointConverter().convert(frame, {}, executor, points));
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double rho = points.range_m[i];
    const double expected =
        1e-4 + std::pow(0.002 * rho, 2) + std::pow(0.0003 * rho * rho, 2) + std::pow(0.009765625, 2) / 12.0;
    ASSERT_NEAR(points.range_variance_m2[i], expected, 1e-5 * expected);
  }
}

TEST(PointConverter, RowsKeepTheirOrderAndTheirSensorPosition) {
  const auto projection = unambiguous_perceptron(64, 48);
  SensorConfig sensor;
  sensor.T_body_sensor = perceptron_mount(1.6, 0.3, 0.3);
  sensor.row_period = std::chrono::milliseconds(5);
  sensor.filter = no_filter();
  const auto frame = scan(projection, sensor, driving_and_turning(), kGround).frame;
  SerialExecutor executor;
  PointFrame points;
  ASSERT_TRUE(PointConverter().convert(frame, {}, executor, points));
  ASSERT_EQ(points.row_begin.size(), 65U);
  EXPECT_EQ(points.row_begin.front(), 0U);
  EXPECT_EQ(points.row_begin.back(), points.size());
  ASSERT_EQ(points.sensor_m.size(), 64U);
  for (std::size_t r = 0; r < 64; ++r) {
    ASSERT_LE(points.row_begin[r], points.row_begin[r + 1]);
    const Eigen::Vector3d sensor_map = (frame.T_map_body[r] * sensor.T_body_sensor).translation_m;
    ASSERT_LT((points.anchor_map_m + points.sensor_m[r].cast<double>() - sensor_map).norm(), 1e-6);
    for (std::size_t i = points.row_begin[r]; i < points.row_begin[r + 1]; ++i)  // |p − sensor| is the range
      ASSERT_NEAR((map_point(points, i) - sensor_map).norm(), points.range_m[i], 1e-5 * (1 + points.range_m[i]));
  }
  EXPECT_EQ(points.time, frame.row_time.back());
}

TEST(PointConverter, CloudsPassThroughLimitsAndMask) {
  std::vector<Eigen::Vector3f> cloud{{5, 0, -1}, {0.2F, 0, 0}, {200, 0, 0}, {-1, 0.5F, -0.5F}, {8, 3, -1}};
  RangeFrame frame;
  frame.projection = make_cloud_projection(cloud);
  SensorConfig sensor;
  sensor.T_body_sensor.translation_m = {0, 0, 1.0};
  sensor.filter.range_min_m = 0.5;
  sensor.filter.self_mask = BodyBox{{-2, -1, 0}, {0, 1, 1}};
  frame.sensor = std::make_shared<const SensorConfig>(sensor);
  frame.range_m = frame.projection->range_offset_m;
  frame.row_time.assign(1, Time{});
  frame.T_map_body.assign(1, Pose{});
  SerialExecutor executor;
  PointFrame points;
  ASSERT_TRUE(PointConverter().convert(frame, {}, executor, points));
  EXPECT_EQ(points.counts.points, 2U);
  EXPECT_EQ(points.counts.out_of_limits, 2U);
  EXPECT_EQ(points.counts.self, 1U);
  EXPECT_EQ(accounted(points.counts), points.counts.pixels);
  EXPECT_LT((map_point(points, 1) - Eigen::Vector3d(8, 3, 0)).norm(), 1e-5);
}

TEST(PointConverter, RefusesFramesThatContradictTheirProjection) {
  const auto projection = unambiguous_perceptron(8, 8);
  SensorConfig sensor;
  const auto good = scan(projection, sensor, standing(), kGround).frame;
  SerialExecutor executor;
  const auto refusal = [&](auto change) {
    RangeFrame frame = good;
    change(frame);
    PointFrame points;
    const auto status = PointConverter().convert(frame, {}, executor, points);
    EXPECT_FALSE(status);
    return status ? std::string() : status.error().message;
  };
  EXPECT_NE(refusal([](auto& f) { f.range_m.assign(8, 7, 1.0F); }).find("expected 8 x 8, found 8 x 7"),
            std::string::npos);
  EXPECT_NE(refusal([](auto& f) { f.T_map_body.pop_back(); }).find("7 poses"), std::string::npos);
  EXPECT_NE(refusal([](auto& f) { f.T_map_body[3].translation_m.x() = std::nan(""); }).find("pose of row 3"),
            std::string::npos);
  EXPECT_NE(refusal([](auto& f) { f.sensor = nullptr; }).find("no sensor"), std::string::npos);
  EXPECT_NE(refusal([](auto& f) { f.projection = nullptr; }).find("no projection"), std::string::npos);
}

TEST(PointConverter, EmptyCloudIsAnEmptyFrame) {
  RangeFrame frame;
  frame.projection = make_cloud_projection({});
  frame.sensor = std::make_shared<const SensorConfig>();
  frame.range_m.assign(1, 0, 0.0F);
  frame.row_time.assign(1, Time{});
  frame.T_map_body.assign(1, Pose{});
  SerialExecutor executor;
  PointFrame points;
  ASSERT_TRUE(PointConverter().convert(frame, {}, executor, points));
  EXPECT_EQ(points.size(), 0U);
  EXPECT_EQ(points.counts.pixels, 0U);
}

}  // namespace
}  // namespace scree
