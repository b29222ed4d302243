// A thousand times: nothing is left behind.

#include <algorithm>
#include <cerrno>
#include <gtest/gtest.h>
#include <linux/videodev2.h>

#include "tests/devices/process_resources.hpp"
#include "tests/devices/v4l2_support.hpp"

namespace scree::drivers {
namespace {

constexpr int kCycles = 1000;

test::Picture any_picture(std::uint32_t sequence) {
  return picture(sequence);
}

TEST(V4l2Cycles, AThousandReplugsLeaveNoDescriptorThreadOrMapping) {
  test::Testbed bed;
  test::Camera camera(bed, {});
  camera.always(any_picture);
  const auto source = opened(test_config());
  next_of(*source, Kind::notice);
  std::uint64_t frames = 0;
  const auto cycle = [&] {
    next_of(*source, Kind::frame);
    ++frames;
    camera.unplug();
    // unplugged between two buffers, or while one is given back: then its frame still comes
    auto event = next_event(*source);
    while (event.kind == Kind::frame) {
      ++frames;
      event = next_event(*source);
    }
    ASSERT_EQ(event.kind, Kind::notice) << event.message;
    camera.plug();
    event = next_of(*source, Kind::notice);
    ASSERT_NE(event.message.find("opened"), std::string::npos) << event.message;
  };
  cycle();  // warm
  const auto before = test::resources(camera.file());
  for (int i = 0; i < kCycles && !testing::Test::HasFailure(); ++i) cycle();
  EXPECT_EQ(test::settled(camera.file(), before), before);
  EXPECT_EQ(counter(*source, "connections"), kCycles + 2u);
  EXPECT_EQ(counter(*source, "losses"), kCycles + 1u);
  EXPECT_EQ(counter(*source, "frames"), frames);
  EXPECT_EQ(counter(*source, "frames_missing"), 0u);
}

TEST(V4l2Cycles, AThousandStartsAndStopsLeaveNoDescriptorThreadOrMapping) {
  test::Testbed bed;
  test::Camera camera(bed, {});
  camera.always(any_picture);
  const auto cycle = [&] {
    const auto source = opened(test_config());
    next_of(*source, Kind::notice);
    next_of(*source, Kind::frame);
  };
  cycle();
  // the other end of the last descriptor is closed a little later: the least that is held is the base line
  auto before = test::resources(camera.file());
  for (int i = 0; i < 50; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    before.descriptors = std::min(before.descriptors, test::resources(camera.file()).descriptors);
  }
  for (int i = 0; i < kCycles && !testing::Test::HasFailure(); ++i) cycle();
  EXPECT_EQ(test::settled(camera.file(), before), before);
  EXPECT_EQ(camera.counts().started, kCycles + 1);
  EXPECT_EQ(camera.counts().stopped, kCycles + 1);
}

TEST(V4l2Cycles, ARefusedNegotiationLeavesNothingAtAnyStep) {
  test::Testbed bed;
  test::Camera camera(bed, {});
  camera.always(any_picture);
  const auto source = opened(test_config());
  next_of(*source, Kind::notice);
  const auto open = test::resources(camera.file());
  for (const unsigned long step :
       {VIDIOC_QUERYCAP, VIDIOC_G_FMT, VIDIOC_S_FMT, VIDIOC_REQBUFS, VIDIOC_QUERYBUF, VIDIOC_QBUF, VIDIOC_STREAMON}) {
    next_of(*source, Kind::frame);  // so that retries begin at the first again
    camera.fail(VIDIOC_DQBUF, EIO, 1);
    next_of(*source, Kind::notice);
    camera.fail(step, EIO, 5);
    next_of(*source, Kind::notice);
    EXPECT_NE(next_of(*source, Kind::notice).message.find("opened"), std::string::npos) << "step " << step;
    EXPECT_EQ(test::settled(camera.file(), open), open) << "step " << step;
  }
}

}  // namespace
}  // namespace scree::drivers
