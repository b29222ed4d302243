// The codec against bytes that an independent generator made (golden/generate.py), in both directions.

#include "tests/drivers/stream_support.hpp"

namespace scree::drivers::stream {
namespace {

Geometry test_lidar() {
  Geometry geometry;
  geometry.device = "lidar";
  SensorConfig& sensor = geometry.sensor;
  sensor.projection.kind = ProjectionKind::spherical;
  sensor.projection.range_per_count_m = 0.002;
  sensor.projection.range_offset_m = -0.25;
  sensor.projection.row_elevations_rad = {0.1, -0.2};
  sensor.projection.column_azimuths_rad = {0.5, 0.0, -0.5};
  sensor.projection = *complete_projection(sensor.projection, 2, 3);
  sensor.T_body_sensor.translation_m.z() = 1.0;
  sensor.noise = {0.02, 0.0, 0.0, 0.001};
  sensor.filter.range_min_m = 0.9;
  sensor.filter.range_max_m = 120.0;
  return geometry;
}

Geometry test_camera() {
  Geometry geometry;
  geometry.device = "depth camera";
  SensorConfig& sensor = geometry.sensor;
  sensor.projection.kind = ProjectionKind::pinhole;
  sensor.projection.fx_px = 80.0;
  sensor.projection.fy_px = 81.0;
  sensor.projection.cx_px = 0.5;
  sensor.projection.cy_px = 0.75;
  sensor.projection = *complete_projection(sensor.projection, 2, 2);
  sensor.T_body_sensor = {{0.0, 0.0, 2.0}, Eigen::Quaterniond(0.0, 1.0, 0.0, 0.0)};
  sensor.noise = {0.005, 0.0, 0.0, 0.0};
  sensor.filter.range_min_m = 0.3;
  sensor.filter.range_max_m = 10.0;
  return geometry;
}

TestFrame flash(int rows, int columns, std::vector<int> counts, std::uint64_t sequence) {
  TestFrame frame;
  frame.sequence = sequence;
  frame.row_time.assign(static_cast<std::size_t>(rows), kTestTime);
  frame.variance = {};
  frame.raw.assign(rows, columns, 0);
  for (std::size_t i = 0; i < counts.size(); ++i) frame.raw[i] = static_cast<std::uint16_t>(counts[i]);
  return frame;
}

TestFrame lidar_frame() {
  return flash(2, 3, {0, 10000, 20000, 30000, 40000, 50000}, ~std::uint64_t{0});
}

TestFrame camera_frame() {
  TestFrame frame = flash(2, 2, {2000, 0, 65535, 1}, 7);
  frame.poses = {{kTestTime, {{7.0, -2.0, 1.25}, Eigen::Quaterniond::Identity()}}};
  return frame;
}

void expect_encoded(const Geometry& geometry, const TestFrame& frame, bool simulated, const std::string& name) {
  const auto encoder = Encoder::make(geometry, kTestBoot, simulated);
  ASSERT_TRUE(encoder) << encoder.error().message;
  const Bytes expected = golden_stream(name);
  ASSERT_FALSE(expected.empty());
  EXPECT_EQ(encoded(*encoder, frame), expected) << name;
}

TEST(FrameStreamGolden, TheEncoderWritesTheseBytes) {
  expect_encoded(test_scanner(), test_frame(0), true, "frame_scanner");
  expect_encoded(test_lidar(), lidar_frame(), false, "frame_lidar");
  expect_encoded(test_camera(), camera_frame(), true, "frame_camera");
}

void expect_sensor(const SensorConfig& found, const SensorConfig& expected) {
  EXPECT_TRUE(check_same_projection("golden", expected.projection, found.projection));
  EXPECT_EQ(found.projection.trusted_rows, expected.projection.trusted_rows);
  EXPECT_EQ(found.projection.reflectance_shift, expected.projection.reflectance_shift);
  EXPECT_EQ(found.T_body_sensor.translation_m, expected.T_body_sensor.translation_m);
  EXPECT_EQ(found.T_body_sensor.rotation.coeffs(), expected.T_body_sensor.rotation.coeffs());
  EXPECT_EQ(found.row_period, expected.row_period);
  EXPECT_EQ(found.noise.sigma_m, expected.noise.sigma_m);
  EXPECT_EQ(found.noise.sigma_per_m, expected.noise.sigma_per_m);
  EXPECT_EQ(found.noise.sigma_per_m2, expected.noise.sigma_per_m2);
  EXPECT_EQ(found.noise.angle_rad, expected.noise.angle_rad);
  EXPECT_EQ(found.filter.range_min_m, expected.filter.range_min_m);
  EXPECT_EQ(found.filter.range_max_m, expected.filter.range_max_m);
}

TEST(FrameStreamGolden, TheseBytesAreReadAsTheScannersFrame) {
  Ears ears;
  ears.hear(golden_stream("frame_scanner"));
  ASSERT_EQ(ears.frames.size(), 1u);
  const RangeFrame& frame = ears.frames.front();
  expect_sensor(*frame.sensor, test_scanner().sensor);
  EXPECT_EQ(ears.reader.device(), "test scanner");
  EXPECT_EQ(frame.sequence, 0u);
  EXPECT_EQ(frame.row_time, test_frame(0).row_time);
  EXPECT_EQ(frame.pose_variance.position_m2, Eigen::Vector3d(0.25, 0.25, 0.5));
  EXPECT_EQ(frame.pose_variance.attitude_rad2, Eigen::Vector3d(0.0, 0.0, 0.0625));
  for (std::size_t i = 0; i < 12; ++i)
    EXPECT_FLOAT_EQ(frame.range_m[i], static_cast<float>(300 * i + 5) * 0.009765625F) << i;
  // row 2 is taken 3 ms into the 10 ms between the poses: 0.3 of the way and of the quarter turn
  EXPECT_NEAR(frame.T_map_body[2].translation_m.x(), 1.15, 1e-12);
  EXPECT_NEAR(frame.T_map_body[2].rotation.angularDistance(Eigen::Quaterniond::Identity()), 0.3 * M_PI_2, 1e-12);
}

TEST(FrameStreamGolden, TheseBytesAreReadAsTheLidarsAndTheCamerasFrame) {
  Ears ears;
  ears.reader = FrameReader(as_told, false);  // the lidar does not know where it is
  ears.hear(golden_stream("frame_lidar"));
  ASSERT_EQ(ears.frames.size(), 1u);
  expect_sensor(*ears.frames[0].sensor, test_lidar().sensor);
  EXPECT_FLOAT_EQ(ears.frames[0].range_m(1, 2), -0.25F + 50000 * 0.002F);
  ears.hear(golden_stream("frame_camera"));
  ASSERT_EQ(ears.frames.size(), 2u);
  expect_sensor(*ears.frames[1].sensor, test_camera().sensor);
  EXPECT_TRUE(std::isnan(ears.frames[1].range_m(0, 1))) << "0 is no return";
  EXPECT_EQ(ears.frames[1].projection->rows, 2);
}

TEST(FrameStreamGolden, TheFlagSaysWhetherTheDeviceIsSimulated) {
  for (const auto& [name, simulated] : {std::pair("frame_scanner", true), {"frame_lidar", false}}) {
    Decoder decoder;
    const Bytes bytes = golden_stream(name);
    std::span<const std::uint8_t> left(bytes);
    while (const auto message = decoder.next(left)) EXPECT_EQ(message->header.simulated, simulated) << name;
    EXPECT_EQ(decoder.counters().messages, 2u);
  }
}

}  // namespace
}  // namespace scree::drivers::stream
