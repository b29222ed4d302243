#include "config/recording_file.hpp"

#include <cstdint>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <numbers>
#include <string>

#include "core/random.hpp"

namespace scree::config {
namespace {

using ::testing::HasSubstr;

constexpr const char* kText = R"(scree_recording: 1
origin: sim
sensor:
  projection: perceptron_usf
  parameters: {unit_m: 0.01, trusted_rows: 512, invalid_raw: 0}
  T_body_sensor: {x_m: 0.3, y_m: 0.0, z_m: 1.6, qx: 0.5, qy: 0.5, qz: 0.5, qw: 0.5}
  row_period_s: 0.0009765625
  range_min_m: 0.5
  range_max_m: 39.0
  range_sigma_m: 0.02
)";

TEST(RecordingFile, ReadsEveryValue) {
  const auto recording = parse_recording(kText, "recording.yaml");
  ASSERT_TRUE(recording) << recording.error().message;
  const SensorConfig& sensor = recording->sensor;
  EXPECT_EQ(recording->origin, drivers::Origin::sim);
  EXPECT_EQ(sensor.projection.kind, ProjectionKind::perceptron_usf);
  EXPECT_EQ(sensor.projection.trusted_rows, 512);
  EXPECT_EQ(sensor.projection.invalid_raw, 0);
  EXPECT_EQ(sensor.T_body_sensor.translation_m, Eigen::Vector3d(0.3, 0.0, 1.6));
  EXPECT_EQ(sensor.T_body_sensor.rotation.coeffs(), Eigen::Vector4d(0.5, 0.5, 0.5, 0.5));
  EXPECT_EQ(sensor.row_period, Duration(976563));  // half a nanosecond rounds up
  EXPECT_EQ(sensor.filter.range_min_m, 0.5);
  EXPECT_EQ(sensor.filter.range_max_m, 39.0);
  EXPECT_EQ(sensor.noise.sigma_m, 0.02);
}

TEST(RecordingFile, WritingAndReadingKeepsEveryBit) {
  for (int i = 0; i < 200; ++i) {
    drivers::RecordingDescription description;
    const auto words = random_words(7, 1, i, 0);
    const auto normals = random_normals(7, 2, i, 0);
    const auto more = random_normals(7, 3, i, 0);
    SensorConfig& sensor = description.sensor;
    sensor.projection.kind = words[0] % 2 == 0 ? ProjectionKind::spherical : ProjectionKind::pinhole;
    if (sensor.projection.kind == ProjectionKind::spherical) {
      sensor.projection.row_elevations_rad = {normals[0] / 8, normals[1] / 8, std::numbers::pi / 7};
      sensor.projection.column_azimuths_rad = {more[0] / 3};
      sensor.projection.range_per_count_m = to_uniform(words[1]);
    } else {
      sensor.projection.fx_px = 500 * to_uniform(words[1]);
      sensor.projection.fy_px = 500 * to_uniform(words[2]);
    }
    sensor.T_body_sensor.translation_m = {normals[0], normals[1] * 1e-9, more[0] * 1e5};
    sensor.T_body_sensor.rotation = Eigen::Quaterniond(more[0], more[1], normals[0], normals[1]).normalized();
    sensor.row_period = Duration(words[3] / 2);
    sensor.filter.self_mask = BodyBox{{-1 - to_uniform(words[0]), -1, -1}, {to_uniform(words[1]), 1, 1}};
    sensor.noise.sigma_m = to_uniform(words[2]);

    const std::string text = write_recording(description);
    const auto read = parse_recording(text, "written");
    ASSERT_TRUE(read) << read.error().message << "\n" << text;
    EXPECT_EQ(read->sensor.T_body_sensor.rotation.coeffs(), sensor.T_body_sensor.rotation.coeffs());
    EXPECT_EQ(read->sensor.T_body_sensor.translation_m, sensor.T_body_sensor.translation_m);
    EXPECT_EQ(read->sensor.projection.row_elevations_rad, sensor.projection.row_elevations_rad);
    EXPECT_EQ(read->sensor.projection.fx_px, sensor.projection.fx_px);
    EXPECT_EQ(read->sensor.row_period, sensor.row_period);
    EXPECT_EQ(write_recording(*read), text);
  }
}

TEST(RecordingFile, MissingKeysAreNamedWhereTheyBelong) {
  const auto recording = parse_recording(
      "scree_recording: 1\nsensor:\n  projection: cloud\n  T_body_sensor: {x_m: 1}\n", "d/recording.yaml");
  ASSERT_FALSE(recording);
  EXPECT_EQ(recording.error().kind, ErrorKind::bad_data);
  EXPECT_THAT(recording.error().message, HasSubstr("d/recording.yaml:4:3: sensor.T_body_sensor.qw: expected a number"));
  EXPECT_THAT(recording.error().message, HasSubstr("found no such key"));
}

TEST(RecordingFile, MixedFaultsAreAllReportedAtOnce) {
  const auto recording = parse_recording(
      "scree_recording: 1\norigin: moon\nsensor:\n  projection: pinhole\n  range_mx_m: 3\n  range_min_m: 500\n"
      "  parameters: {unit_m: 0.01}\n"
      "  T_body_sensor: {x_m: 0, y_m: 0, z_m: 0, qx: 0, qy: 0, qz: 0, qw: 0.5}\n",
      "recording.yaml");
  ASSERT_FALSE(recording);
  const std::string& faults = recording.error().message;
  EXPECT_THAT(faults, HasSubstr("recording.yaml:2:9: origin: expected one of"));
  EXPECT_THAT(faults, HasSubstr("sensor.range_mx_m: expected a known key (nearest: sensor.range_max_m)"));
  EXPECT_THAT(faults, HasSubstr("sensor.parameters.unit_m: expected projection perceptron_usf, found another one"));
  EXPECT_THAT(faults, HasSubstr("fx_px and fy_px with projection pinhole"));
  EXPECT_THAT(faults, HasSubstr("range_min_m below range_max_m"));
  EXPECT_THAT(faults, HasSubstr("expected qx qy qz qw of norm 1"));
}

TEST(RecordingFile, NotARecordingIsBadData) {
  for (const char* text :
       {"", "scree_recording: 2\n", "[]", "\"", "scree_recording: 1\nsensor: {projection: sonar}\n"}) {
    const auto recording = parse_recording(text, "recording.yaml");
    ASSERT_FALSE(recording) << text;
    EXPECT_EQ(recording.error().kind, ErrorKind::bad_data);
    EXPECT_THAT(recording.error().message, HasSubstr("recording.yaml:")) << text;
  }
}

TEST(RecordingFile, MissingFileIsNoInput) {
  const auto recording = read_recording("/nowhere");
  ASSERT_FALSE(recording);
  EXPECT_EQ(recording.error().kind, ErrorKind::no_input);
  EXPECT_THAT(recording.error().message, HasSubstr("/nowhere/recording.yaml: expected the description of a recording"));
}

}  // namespace
}  // namespace scree::config
