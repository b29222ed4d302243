// Frames as they were mapped, written and read back: ranges, poses and variances to the last bit.

#include "drivers/live_recording.hpp"

#include <cmath>
#include <cstring>
#include <fmt/format.h>
#include <limits>

#include "tests/drivers/recording_fixture.hpp"

namespace scree::drivers {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

class LiveRecordingTest : public ::testing::Test {
 protected:
  LiveRecordingTest() {
    recording_.emplace(folder_ / "taken", [this](const RecordingDescription& description) {
      description_ = description;  // YAML is config's business: here the description itself is handed on
      return fmt::format("{} {}", static_cast<int>(description.origin), description.sensor.filter.range_max_m);
    });
  }

  /// What a source would deliver of `raw`.
  RangeFrame frame(const SensorConfig& sensor, const Grid<std::uint16_t>& raw, double t_s) {
    RangeFrame out;
    auto projection = make_projection(sensor.projection, raw.rows(), raw.columns());
    EXPECT_TRUE(projection);
    out.projection = *projection;
    out.sensor = std::make_shared<const SensorConfig>(sensor);
    out.sequence = 17;
    out.time = at(t_s);
    out.raw = raw;
    out.range_m.reshape(raw.rows(), raw.columns());
    for (std::size_t i = 0; i < raw.size(); ++i) {
      const auto& p = *out.projection;
      out.range_m[i] = raw[i] == p.config.invalid_raw
                           ? kNaN
                           : p.range_offset_m[i] + static_cast<float>(raw[i]) * p.range_per_count_m[i];
    }
    for (int row = 0; row < raw.rows(); ++row) out.row_time.push_back(out.time + row * sensor.row_period);
    return out;
  }
  Status add(const RangeFrame& frame, const std::vector<Pose>& poses, const PoseVariance& variance = {}) {
    return recording_->add({frame, poses, variance, Origin::sim});
  }
  Delivered read_back() {
    EXPECT_TRUE(recording_->finish());
    const auto source = open_recording(folder_ / "taken", description_, {});
    EXPECT_TRUE(source) << source.error().message;
    return source ? drain(**source) : Delivered{};
  }

  test::TemporaryFolder folder_;
  RecordingDescription description_;
  std::optional<LiveRecording> recording_;
};

void expect_same_bits(const Grid<float>& a, const Grid<float>& b) {
  ASSERT_EQ(a.size(), b.size());
  EXPECT_EQ(std::memcmp(a.data(), b.data(), a.size() * sizeof(float)), 0);
}

std::vector<Pose> poses_of(int rows, double begin) {
  std::vector<Pose> poses;
  for (int i = 0; i < rows; ++i) {
    Pose pose{{begin + 0.1 * i, 1.0 / 3.0, -1e-9 * i},
              Eigen::Quaterniond(Eigen::AngleAxisd(begin + 0.01 * i, Eigen::Vector3d(1, 2, 3).normalized()))};
    normalise(pose);
    poses.push_back(pose);
  }
  return poses;
}

TEST_F(LiveRecordingTest, FramesPosesAndVariancesComeBackToTheLastBit) {
  Grid<std::uint16_t> raw(256, 256);
  for (std::size_t i = 0; i < raw.size(); ++i) raw[i] = static_cast<std::uint16_t>((i * 2654435761u) >> 20 & 0xFFF);
  const SensorConfig sensor = cmu_scanner(from_seconds(1.0 / 1024.0));
  std::vector<RangeFrame> frames;
  std::vector<std::vector<Pose>> poses;
  std::vector<PoseVariance> variances;
  for (int i = 0; i < 3; ++i) {
    frames.push_back(frame(sensor, raw, 1.7e9 + i));
    poses.push_back(poses_of(256, 100.0 * i));
    variances.push_back({{0.1 * i, 0.2, 0.3}, {1e-6, 2e-6, 1e-5 * i}});
    ASSERT_TRUE(add(frames.back(), poses.back(), variances.back()));
  }
  EXPECT_EQ(recording_->frames(), 3u);
  EXPECT_EQ(recording_->restamped(), 0u);
  const auto delivered = read_back();
  ASSERT_EQ(delivered.frames.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    const RangeFrame& back = *delivered.frames[i];
    expect_same_bits(back.range_m, frames[i].range_m);
    EXPECT_EQ(back.time, frames[i].time);
    EXPECT_EQ(back.row_time, frames[i].row_time);
    EXPECT_EQ(back.sequence, 17u);
    for (std::size_t r = 0; r < 256; ++r) {
      ASSERT_EQ(back.T_map_body[r].translation_m, poses[i][r].translation_m) << i << ' ' << r;
      ASSERT_EQ(back.T_map_body[r].rotation.coeffs(), poses[i][r].rotation.coeffs()) << i << ' ' << r;
    }
    EXPECT_EQ(back.pose_variance.position_m2, variances[i].position_m2);
    EXPECT_EQ(back.pose_variance.attitude_rad2, variances[i].attitude_rad2);
  }
}

TEST_F(LiveRecordingTest, WeakReturnsAreRemovedAgainByTheirReflectance) {
  SensorConfig sensor = cmu_scanner({});
  sensor.projection.reflectance_shift = 16;
  sensor.filter.min_reflectance = 100;
  RangeFrame taken = frame(sensor, Grid<std::uint16_t>(256, 256, 900), 5.0);
  taken.reflectance = Grid<std::uint16_t>(256, 256, 500);
  taken.reflectance(3, 4) = 99;
  taken.range_m(3, 4) = kNaN;
  ASSERT_TRUE(add(taken, std::vector<Pose>(256)));
  const auto delivered = read_back();
  ASSERT_EQ(delivered.frames.size(), 1u);
  EXPECT_TRUE(std::isnan(delivered.frames[0]->range_m(3, 4)));
  EXPECT_FALSE(std::isnan(delivered.frames[0]->range_m(3, 5)));
  EXPECT_EQ(delivered.frames[0]->reflectance(3, 4), 99) << "the count is kept, not only its verdict";
}

TEST_F(LiveRecordingTest, WhereAFileHasNoPlaceForTheReflectanceAWeakReturnBecomesNone) {
  SensorConfig sensor = depth_camera();
  sensor.projection.invalid_raw = 0;
  sensor.filter.min_reflectance = 100;
  RangeFrame taken = frame(sensor, Grid<std::uint16_t>(2, 3, 900), 5.0);
  taken.range_m(1, 1) = kNaN;
  ASSERT_TRUE(add(taken, std::vector<Pose>(2)));
  const auto delivered = read_back();
  ASSERT_EQ(delivered.frames.size(), 1u);
  expect_same_bits(delivered.frames[0]->range_m, taken.range_m);
}

TEST_F(LiveRecordingTest, WhatTheFormatCannotHoldIsRefusedAndTheRecordingGoesOn) {
  const SensorConfig sensor = depth_camera();
  const Grid<std::uint16_t> raw(2, 3, 900);
  const auto refusal = [&](const RangeFrame& taken, const std::vector<Pose>& poses) {
    const Status status = add(taken, poses);
    EXPECT_FALSE(status);
    EXPECT_EQ(status.error().kind, ErrorKind::bad_data) << status.error().message;
    return status ? std::string() : status.error().message;
  };
  const std::vector<Pose> still(2);
  ASSERT_TRUE(add(frame(sensor, raw, 5.0), still));
  EXPECT_THAT(refusal(frame(sensor, raw, 5.0), still), HasSubstr("expected a time above 5 s, found 5 s"));
  EXPECT_THAT(refusal(frame(sensor, raw, 6.0), poses_of(2, 0.0)), HasSubstr("expected one pose for a frame"));
  SensorConfig another = sensor;
  another.filter.range_max_m = 3.0;
  EXPECT_THAT(refusal(frame(another, raw, 7.0), still), HasSubstr("expected the sensor of the frames before it"));
  RangeFrame cloud = frame(sensor, raw, 8.0);
  cloud.raw = {};
  EXPECT_THAT(refusal(cloud, still), HasSubstr("expected the counts of an image"));
  ASSERT_TRUE(add(frame(sensor, raw, 9.0), still)) << "an equal sensor, opened again";
  EXPECT_EQ(read_back().frames.size(), 2u);
}

TEST_F(LiveRecordingTest, RowsOfAnotherClockAreRestampedAndCounted) {
  RangeFrame taken = frame(cmu_scanner(1ms), Grid<std::uint16_t>(256, 256, 900), 5.0);
  taken.row_time[7] += 1us;
  const auto poses = poses_of(256, 0.0);
  ASSERT_TRUE(add(taken, poses));
  EXPECT_EQ(recording_->restamped(), 1u);
  const auto delivered = read_back();
  ASSERT_EQ(delivered.frames.size(), 1u);
  EXPECT_EQ(delivered.frames[0]->T_map_body[7].translation_m, poses[7].translation_m);
}

}  // namespace
}  // namespace scree::drivers
