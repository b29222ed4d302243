// The V4L2 source against a camera that umockdev makes: what arrives, what is skipped, what is counted.

#include <cfloat>
#include <cmath>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <linux/videodev2.h>

#include "tests/devices/v4l2_support.hpp"

namespace scree::drivers {
namespace {

using testing::HasSubstr;

/// Depth along z → metres along the ray.
double along_ray(const ProjectionConfig& p, int row, int column, double depth_m) {
  return depth_m * std::hypot(1.0, (column - p.cx_px) / p.fx_px, (row - p.cy_px) / p.fy_px);
}

void expect_metres(const RangeFrame& frame, const std::vector<std::uint16_t>& counts, int invalid = 0) {
  const ProjectionConfig& p = frame.projection->config;
  ASSERT_EQ(frame.range_m.size(), counts.size());
  for (int r = 0; r < frame.range_m.rows(); ++r)
    for (int c = 0; c < frame.range_m.columns(); ++c) {
      const std::uint16_t count = counts[static_cast<std::size_t>(r * frame.range_m.columns() + c)];
      EXPECT_EQ(frame.raw(r, c), count);
      const double expected = along_ray(p, r, c, count * p.depth_unit_m);
      if (count == invalid)
        EXPECT_TRUE(std::isnan(frame.range_m(r, c)));
      else  // the table's float and one product
        EXPECT_NEAR(frame.range_m(r, c), expected, 2.0 * static_cast<double>(FLT_EPSILON) * expected);
    }
}

TEST(V4l2Source, FramesArriveAsMetresAlongTheRays) {
  test::Testbed bed;
  test::Camera camera(bed, {});
  const auto source = opened(test_config());
  EXPECT_THAT(next_of(*source, Kind::notice).message, HasSubstr("opened 'Fake Depth', Z16 8 x 6 at 30 Hz"));
  camera.deliver(picture(0));
  camera.deliver(picture(1, 48, 900));
  const auto first = next_of(*source, Kind::frame), second = next_of(*source, Kind::frame);
  expect_metres(*first.frame, picture(0).words);
  expect_metres(*second.frame, picture(1, 48, 900).words);
  EXPECT_EQ(first.message, "");
  EXPECT_EQ(first.frame->sensor->projection.rows, 6);
  EXPECT_EQ(first.frame->sensor->projection.columns, 8);
  EXPECT_EQ(first.frame->sequence, 0u);
  EXPECT_EQ(second.frame->sequence, 1u);
  EXPECT_TRUE(first.frame->reflectance.empty());
  ASSERT_EQ(first.frame->T_map_body.size(), 6u);
  for (const Pose& pose : first.frame->T_map_body) EXPECT_TRUE(pose.translation_m.isZero(0.0));
  EXPECT_EQ(counter(*source, "frames"), 2u);
  EXPECT_EQ(counter(*source, "connections"), 1u);
  EXPECT_EQ(source->origin(), Origin::live);
  EXPECT_EQ(source->name(), "v4l2 /dev/video0");
}

TEST(V4l2Source, PaddingBehindTheRowsIsNoDepth) {
  test::Testbed bed;
  test::Camera camera(bed, {.padding = 14});
  const auto source = opened(test_config());
  next_of(*source, Kind::notice);
  camera.deliver(picture(0));
  auto last_row_short = picture(1);
  last_row_short.bytesused = 30 * 5 + 16;  // the padding of the last row may be left out
  camera.deliver(last_row_short);
  expect_metres(*next_of(*source, Kind::frame).frame, picture(0).words);
  expect_metres(*next_of(*source, Kind::frame).frame, picture(1).words);
}

TEST(V4l2Source, TwelveBitWordsLoseTheirUpperBits) {
  test::Testbed bed;
  test::Camera camera(bed, {.formats = {v4l2::fourcc_of("YUYV"), v4l2::fourcc_of("Y12 ")}});
  auto config = test_config();
  config.sensor.projection.invalid_raw = 4095;
  const auto source = opened(config);
  EXPECT_THAT(next_of(*source, Kind::notice).message, HasSubstr("Y12 8 x 6"));
  auto sent = picture(0);
  sent.words[5] = 0x0FFF;
  auto expected = sent.words;
  for (std::uint16_t& word : sent.words) word = static_cast<std::uint16_t>(word | 0xB000U);
  for (std::uint16_t& word : expected) word = static_cast<std::uint16_t>(word & 0x0FFFU);
  camera.deliver(sent);
  expect_metres(*next_of(*source, Kind::frame).frame, expected, 4095);
}

TEST(V4l2Source, AFrameOfTheFormatThatWasAskedForThoughAnotherIsPreferred) {
  test::Testbed bed;
  test::Camera camera(bed, {.formats = {v4l2::fourcc_of("Z16 "), v4l2::fourcc_of("Y16 ")}});
  auto config = test_config();
  config.format = "Y16";
  const auto source = opened(config);
  EXPECT_THAT(next_of(*source, Kind::notice).message, HasSubstr("Y16 8 x 6"));
}

TEST(V4l2Source, FlaggedAndShortBuffersAreSkippedAndMissingOnesCounted) {
  test::Testbed bed;
  test::Camera camera(bed, {});
  const auto source = opened(test_config());
  next_of(*source, Kind::notice);
  auto flagged = picture(1);
  flagged.flagged = true;
  auto cut = picture(2);
  cut.bytesused = 95;
  for (const auto& sent : {picture(0), flagged, cut, picture(6), picture(6), picture(7)}) camera.deliver(sent);
  next_of(*source, Kind::frame);
  EXPECT_THAT(next_of(*source, Kind::skipped).message, HasSubstr("flags as corrupt"));
  EXPECT_THAT(next_of(*source, Kind::skipped).message, HasSubstr("expected 96 bytes, found 95"));
  EXPECT_EQ(next_of(*source, Kind::frame).frame->sequence, 6u);
  EXPECT_EQ(next_of(*source, Kind::frame).frame->sequence, 7u);  // said 6 again: no news
  EXPECT_EQ(next_of(*source, Kind::frame).frame->sequence, 8u);
  EXPECT_EQ(counter(*source, "frames"), 4u);
  EXPECT_EQ(counter(*source, "flagged"), 1u);
  EXPECT_EQ(counter(*source, "short"), 1u);
  EXPECT_EQ(counter(*source, "frames_missing"), 3u);  // 3, 4, 5
}

TEST(V4l2Source, TimesAreThoseOfTheStampsAndOfTheRows) {
  test::Testbed bed;
  test::Camera camera(bed, {});
  auto config = test_config();
  config.sensor.row_period = std::chrono::milliseconds(1);
  const auto source = opened(config);
  next_of(*source, Kind::notice);
  // whole microseconds, as the driver's stamps have
  const auto start =
      std::chrono::floor<std::chrono::microseconds>(MonotonicClock::now() - std::chrono::milliseconds(200));
  auto at_start = picture(0), at_end = picture(1);
  at_start.stamp = start;
  at_end.stamp = start + std::chrono::milliseconds(40);
  at_end.start_of_exposure = false;  // its stamp is of the last row, 5 ms after the first
  camera.deliver(at_start);
  camera.deliver(at_end);
  const auto before = v4l2::read_clocks();
  const auto first = next_of(*source, Kind::frame).frame, second = next_of(*source, Kind::frame).frame;
  // The bracket of a reading is the only slack: half a millisecond would need three interrupted readings.
  const auto expected = before.unix + (start - before.monotonic);
  const auto near = [](Time a, Time b) { return std::chrono::abs(a - b) < std::chrono::microseconds(500); };
  EXPECT_TRUE(near(first->time, expected)) << (first->time - expected).count() << " ns";
  EXPECT_TRUE(near(second->time, expected + std::chrono::milliseconds(35)))
      << (second->time - expected).count() << " ns";
  ASSERT_EQ(first->row_time.size(), 6u);
  EXPECT_EQ(first->row_time[0], first->time);
  EXPECT_EQ(first->row_time[5] - first->time, std::chrono::milliseconds(5));
  EXPECT_EQ(counter(*source, "arrival_times"), 0u);
}

TEST(V4l2Source, WithoutMonotonicStampsFramesHaveTheTimeOfTheirArrivalAndThatIsSaidOnce) {
  test::Testbed bed;
  test::Camera camera(bed, {});
  const auto source = opened(test_config());
  next_of(*source, Kind::notice);
  for (std::uint32_t i = 0; i < 2; ++i) {
    auto sent = picture(i);
    sent.monotonic = false;
    sent.stamp = MonotonicTime(std::chrono::seconds(1));
    camera.deliver(sent);
  }
  const auto before = std::chrono::system_clock::now();
  const auto first = next_of(*source, Kind::frame), second = next_of(*source, Kind::frame);
  EXPECT_THAT(first.message, HasSubstr("time of their arrival"));
  EXPECT_EQ(second.message, "");
  EXPECT_GE(first.frame->time, before - std::chrono::milliseconds(1));
  EXPECT_GT(second.frame->time, first.frame->time);
  EXPECT_EQ(counter(*source, "arrival_times"), 2u);
}

TEST(V4l2Source, FramesOnceReturnedAreFilledAgain) {
  test::Testbed bed;
  test::Camera camera(bed, {});
  camera.always([](std::uint32_t sequence) { return picture(sequence); });
  const auto source = opened(test_config());
  next_of(*source, Kind::notice);
  const auto* counts = next_of(*source, Kind::frame).frame->raw.data();
  for (int i = 0; i < 10; ++i) EXPECT_EQ(next_of(*source, Kind::frame).frame->raw.data(), counts);
}

}  // namespace
}  // namespace scree::drivers
