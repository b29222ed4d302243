// The list of connected V4L2 devices.

#include <cerrno>
#include <filesystem>
#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <linux/videodev2.h>
#include <unistd.h>

#include "drivers/v4l2_devices.hpp"
#include "tests/devices/v4l2_support.hpp"

namespace scree::drivers {
namespace {

using testing::HasSubstr;

TEST(V4l2List, HasEveryNodeByNumberWithWhatItOffersAndWhyItIsOfNoUse) {
  test::Testbed bed;
  test::Camera depth(bed, {.node = "video10"});
  test::Camera colour(bed, {.node = "video2", .formats = {v4l2::fourcc_of("YUYV")}});
  std::ofstream(bed.root() + "/dev/video3") << "a file";
  std::ofstream(bed.root() + "/dev/videophone") << "no node of ours";
  std::filesystem::create_directories(bed.root() + "/dev/v4l/by-id");
  std::filesystem::create_symlink("../../video10", bed.root() + "/dev/v4l/by-id/usb-Fake_Depth-index0");

  const auto found = list_v4l2_devices();
  ASSERT_EQ(found.size(), 3u);
  EXPECT_EQ(found[0].path, "/dev/video2");
  EXPECT_THAT(found[0].reason, HasSubstr("expected a range format (Z16, Y16 or Y12), found YUYV 8 x 6"));
  EXPECT_EQ(found[1].path, "/dev/video3");
  EXPECT_THAT(found[1].reason, HasSubstr("'/dev/video3': expected a V4L2 device, found something else"));
  const V4l2DeviceInfo& info = found[2];
  EXPECT_EQ(info.path, "/dev/video10");
  EXPECT_EQ(info.stable, "/dev/v4l/by-id/usb-Fake_Depth-index0");
  EXPECT_EQ(info.reason, "");
  EXPECT_EQ(info.capabilities.card, "Fake Depth");
  EXPECT_EQ(info.capabilities.driver, "fake");
  EXPECT_EQ(info.capabilities.bus, "usb-fake-1");
  EXPECT_EQ(v4l2::offers_text(info.capabilities.formats), "Z16 8 x 6 at 30 Hz");
}

TEST(V4l2List, OfAMachineWithoutDevicesIsEmpty) {
  const test::Testbed bed;
  EXPECT_TRUE(list_v4l2_devices().empty());
}

TEST(V4l2List, ANodeThatMayNotBeOpenedHasTheReasonAndWhatHelps) {
  if (geteuid() != 0) GTEST_SKIP() << "needs root, to become somebody who may not open the node";
  test::Testbed bed;
  std::filesystem::permissions(bed.root(), std::filesystem::perms(0755));
  std::ofstream(bed.root() + "/dev/video0") << "";
  std::filesystem::permissions(bed.root() + "/dev/video0", std::filesystem::perms(0600));
  for (const auto& entry : std::filesystem::directory_iterator(bed.root() + "/ioctl"))  // the testbed's own doors
    std::filesystem::permissions(entry.path(), std::filesystem::perms(0777));
  ASSERT_EQ(seteuid(65534), 0);
  const auto found = list_v4l2_devices();
  ASSERT_EQ(seteuid(0), 0);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_THAT(found[0].reason, HasSubstr("Permission denied"));
  EXPECT_THAT(found[0].reason, HasSubstr("group 'video'"));
  EXPECT_THAT(found[0].reason, HasSubstr("launch/99-scree.rules"));
}

}  // namespace
}  // namespace scree::drivers
