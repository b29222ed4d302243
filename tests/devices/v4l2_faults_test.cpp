// The V4L2 source when the device is not there, refuses, goes away, falls silent or comes back as another.

#include <cerrno>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <linux/videodev2.h>
#include <thread>

#include "tests/devices/v4l2_support.hpp"

namespace scree::drivers {
namespace {

using testing::AllOf;
using testing::HasSubstr;

/// What the source says first of a camera of such settings.
std::string first_notice(const test::CameraSettings& settings, const V4l2SourceConfig& config,
                         unsigned long request = 0, int error = 0) {
  test::Testbed bed;
  test::Camera camera(bed, settings);
  if (request != 0) camera.fail(request, error);
  const auto source = opened(config);
  return next_of(*source, Kind::notice).message;
}

TEST(V4l2Refusal, NamesTheDeviceWhatWasExpectedWhatWasFoundAndWhatItOffers) {
  auto config = test_config();
  config.format = "Y16";
  EXPECT_THAT(first_notice({}, config), AllOf(HasSubstr("'/dev/video0' (Fake Depth): expected Y16, found"),
                                              HasSubstr("the device offers Z16 8 x 6 at 30 Hz")));
  config = test_config();
  config.sensor.projection.rows = 480;
  config.sensor.projection.columns = 640;
  EXPECT_THAT(first_notice({}, config), AllOf(HasSubstr("expected Z16 640 x 480, found Z16 8 x 6"),
                                              HasSubstr("the device offers Z16 8 x 6 at 30 Hz")));
  config = test_config();
  EXPECT_THAT(first_notice({.formats = {v4l2::fourcc_of("YUYV")}}, config),
              AllOf(HasSubstr("expected a range format (Z16, Y16 or Y12), found YUYV 8 x 6")));
  EXPECT_THAT(first_notice({.device_caps = V4L2_CAP_META_CAPTURE | V4L2_CAP_STREAMING}, config),
              HasSubstr("expected video capture"));
  EXPECT_THAT(first_notice({.device_caps = V4L2_CAP_VIDEO_CAPTURE}, config), HasSubstr("expected streaming I/O"));
  EXPECT_THAT(first_notice({}, config, VIDIOC_QUERYCAP, ENOTTY), HasSubstr("expected a V4L2 device"));
  EXPECT_THAT(first_notice({}, config, VIDIOC_S_FMT, EINVAL), HasSubstr("expected Z16 8 x 6, found a refusal"));
  EXPECT_THAT(first_notice({}, config, VIDIOC_S_FMT, EBUSY), HasSubstr("another program uses the device"));
  EXPECT_THAT(first_notice({}, config, VIDIOC_STREAMON, EIO), HasSubstr("VIDIOC_STREAMON: expected success, found: "));
}

TEST(V4l2Refusal, AnotherRateIsSaidAndLivedWith) {
  auto config = test_config();
  config.rate_hz = 60.0;
  EXPECT_THAT(first_notice({}, config), AllOf(HasSubstr("opened"), HasSubstr("rate: expected 60 Hz, found 30 Hz")));
  config.rate_hz = 30.0;
  EXPECT_THAT(first_notice({}, config), testing::Not(HasSubstr("rate:")));
  EXPECT_THAT(first_notice({}, config, VIDIOC_G_PARM, ENOTTY), HasSubstr("found a device whose rate cannot be set"));
}

TEST(V4l2Refusal, IsRetriedAndSaidAgainOnlyWhenTheReasonIsAnother) {
  test::Testbed bed;
  test::Camera camera(bed, {});
  camera.fail(VIDIOC_REQBUFS, EBUSY);
  const auto source = opened(test_config());
  EXPECT_THAT(next_of(*source, Kind::notice).message, HasSubstr("VIDIOC_REQBUFS"));
  EXPECT_EQ(source->next(milliseconds(100))->kind, Kind::timeout);
  camera.fail(VIDIOC_REQBUFS, 0, 0);
  camera.fail(VIDIOC_S_FMT, EBUSY);
  EXPECT_THAT(next_of(*source, Kind::notice).message, HasSubstr("VIDIOC_S_FMT"));
  camera.fail(VIDIOC_S_FMT, 0, 0);
  EXPECT_THAT(next_of(*source, Kind::notice).message, HasSubstr("opened"));
  EXPECT_EQ(counter(*source, "connections"), 1u);
  EXPECT_EQ(counter(*source, "losses"), 0u);
}

TEST(V4l2Refusal, WhatNoDeviceCanMendIsAnError) {
  const auto message = [](const auto& change) {
    auto config = test_config();
    change(config);
    const auto source = open_v4l2(config);
    if (source) return std::string("none");
    EXPECT_EQ(source.error().kind, ErrorKind::bad_config);
    return source.error().message;
  };
  EXPECT_EQ(message([](auto&) {}), "none");
  EXPECT_THAT(message([](auto& c) { c.sensor.projection.kind = ProjectionKind::spherical; }),
              HasSubstr("projection: expected pinhole, found spherical"));
  EXPECT_THAT(message([](auto& c) { c.sensor.projection.fx_px = 0.0; }), HasSubstr("fx_px"));
  EXPECT_THAT(message([](auto& c) { c.format = "MJPG"; }),
              HasSubstr("expected Z16, Y16 or Y12, or none, found 'MJPG'"));
  EXPECT_THAT(message([](auto& c) { c.rate_hz = 0.4; }), HasSubstr("within the deadline of 2000 ms, found 0.4 Hz"));
  EXPECT_THAT(message([](auto& c) { c.rate_hz = -1.0; }), HasSubstr("rate_hz"));
  EXPECT_THAT(message([](auto& c) { c.device = ""; }), HasSubstr("device: expected the path"));
  EXPECT_THAT(message([](auto& c) { c.deadline = milliseconds(0); }), HasSubstr("deadline: expected 1 ms or more"));
  EXPECT_EQ(message([](auto& c) { c.sensor.projection.trusted_rows = 480; }), "none");  // it depends on the size
}

TEST(V4l2Refusal, ASensorThatCannotHaveTheDevicesSizeIsAnErrorOnceThatIsKnown) {
  test::Testbed bed;
  test::Camera camera(bed, {});
  auto config = test_config();
  config.sensor.projection.trusted_rows = 480;
  const auto source = opened(config);
  const auto event = source->next(milliseconds(1000));
  ASSERT_FALSE(event);
  EXPECT_EQ(event.error().kind, ErrorKind::bad_config);
  EXPECT_THAT(event.error().message,
              AllOf(HasSubstr("/dev/video0"), HasSubstr("trusted_rows: expected 1..6, found 480")));
}

TEST(V4l2Faults, ADeviceThatIsNotThereIsSaidOnceAndOpenedWhenItComes) {
  test::Testbed bed;
  test::Camera camera(bed, {});
  camera.hide_node();
  const auto source = opened(test_config());
  EXPECT_THAT(next_of(*source, Kind::notice).message,
              HasSubstr("'/dev/video0': expected a device that can be opened, found: No such file"));
  EXPECT_EQ(source->next(milliseconds(100))->kind, Kind::timeout);
  camera.show_node();
  EXPECT_THAT(next_of(*source, Kind::notice).message, HasSubstr("opened"));
}

class V4l2Loss : public testing::TestWithParam<int> {};

TEST_P(V4l2Loss, IsOneNoticeAndFramesGoOnWhenTheDeviceIsBack) {
  test::Testbed bed;
  test::Camera camera(bed, {});
  const auto source = opened(test_config());
  next_of(*source, Kind::notice);
  camera.deliver(picture(40));
  EXPECT_EQ(next_of(*source, Kind::frame).frame->sequence, 0u);
  camera.fail(VIDIOC_DQBUF, GetParam(), 1);
  camera.fail(VIDIOC_QUERYCAP, ENODEV, 5);
  EXPECT_THAT(next_of(*source, Kind::notice).message, AllOf(HasSubstr("VIDIOC_DQBUF"), HasSubstr("opening it again")));
  EXPECT_THAT(next_of(*source, Kind::notice).message, HasSubstr("opened"));
  camera.deliver(picture(60));
  camera.deliver(picture(62));
  EXPECT_EQ(next_of(*source, Kind::frame).frame->sequence, 1u);  // goes on, whatever the device counts
  EXPECT_EQ(next_of(*source, Kind::frame).frame->sequence, 3u);
  EXPECT_EQ(counter(*source, "frames_missing"), 1u);  // of one run only
  EXPECT_EQ(counter(*source, "connections"), 2u);
  EXPECT_EQ(counter(*source, "losses"), 1u);
  EXPECT_EQ(counter(*source, "silences"), 0u);
}

INSTANTIATE_TEST_SUITE_P(OfEveryKind, V4l2Loss, testing::Values(ENODEV, EIO, EPIPE, EINVAL));

TEST(V4l2Faults, ABufferThatCannotBeGivenBackDoesNotCostItsFrame) {
  test::Testbed bed;
  test::Camera camera(bed, {});
  const auto source = opened(test_config());
  next_of(*source, Kind::notice);
  camera.deliver(picture(0));
  camera.fail(VIDIOC_QBUF, ENODEV, 1);
  next_of(*source, Kind::frame);
  camera.unplug();
  EXPECT_THAT(next_of(*source, Kind::notice).message, HasSubstr("opening it again"));
}

TEST(V4l2Faults, ASilentDeviceIsOpenedAgainAndCounted) {
  test::Testbed bed;
  test::Camera camera(bed, {});
  auto config = test_config();
  config.deadline = milliseconds(50);
  const auto source = opened(config);
  next_of(*source, Kind::notice);
  EXPECT_THAT(next_of(*source, Kind::notice).message, HasSubstr("expected a good frame within 50 ms, found none"));
  EXPECT_THAT(next_of(*source, Kind::notice).message, HasSubstr("opened"));
  EXPECT_EQ(counter(*source, "silences"), 1u);
  EXPECT_EQ(counter(*source, "losses"), 1u);
  EXPECT_EQ(camera.counts().started, 2);
  EXPECT_EQ(camera.counts().stopped, 1);
}

TEST(V4l2Faults, WhoAsksLateFindsTheFrameThatCameAndNoSilence) {
  test::Testbed bed;
  test::Camera camera(bed, {});
  auto config = test_config();
  config.deadline = milliseconds(50);
  const auto source = opened(config);
  next_of(*source, Kind::notice);
  camera.deliver(picture(0));
  std::this_thread::sleep_for(milliseconds(60));
  next_of(*source, Kind::frame);
  EXPECT_EQ(counter(*source, "silences"), 0u);
}

TEST(V4l2Faults, AnotherSizeAfterAReplugIsAnotherProjection) {
  test::Testbed bed;
  test::Camera camera(bed, {});
  const auto source = opened(test_config());
  next_of(*source, Kind::notice);
  camera.deliver(picture(0));
  const auto before = next_of(*source, Kind::frame).frame;
  camera.unplug();
  next_of(*source, Kind::notice);
  camera.change([](test::CameraSettings& settings) { settings.columns = 10; });
  camera.plug();
  EXPECT_THAT(next_of(*source, Kind::notice).message, HasSubstr("Z16 10 x 6"));
  camera.deliver(picture(0, 60));
  const auto after = next_of(*source, Kind::frame).frame;
  EXPECT_EQ(after->projection->columns, 10);
  EXPECT_EQ(after->range_m.columns(), 10);
  EXPECT_EQ(before->projection->columns, 8);  // frames that are out keep theirs
}

TEST(V4l2Faults, AnotherSizeAfterAReplugIsRefusedWhereOneIsConfigured) {
  test::Testbed bed;
  test::Camera camera(bed, {});
  auto config = test_config();
  config.sensor.projection.rows = 6;
  config.sensor.projection.columns = 8;
  const auto source = opened(config);
  next_of(*source, Kind::notice);
  camera.unplug();
  next_of(*source, Kind::notice);
  camera.change([](test::CameraSettings& settings) { settings.columns = 10; });
  camera.plug();
  EXPECT_THAT(next_of(*source, Kind::notice).message, HasSubstr("expected Z16 8 x 6, found Z16 10 x 6"));
}

}  // namespace
}  // namespace scree::drivers
