// A build without libusb says so; the others are tested in tests/devices.

#include <gmock/gmock.h>

#include "drivers/usb_devices.hpp"
#include "drivers/usb_source.hpp"

namespace scree::drivers {
namespace {

TEST(UsbAbsent, ABinaryWithoutUsbSaysSo) {
#ifndef SCREE_WITHOUT_USB
  GTEST_SKIP() << "this binary was built with USB";
#else
  const auto source = open_usb({}, [](const SensorConfig& told) -> Result<SensorConfig> { return told; });
  ASSERT_FALSE(source);
  EXPECT_EQ(source.error().kind, ErrorKind::unavailable);
  EXPECT_THAT(source.error().message, ::testing::HasSubstr("built without it"));
  const auto listed = list_usb_scanners();
  ASSERT_FALSE(listed);
  EXPECT_EQ(listed.error().kind, ErrorKind::unavailable);
#endif
}

}  // namespace
}  // namespace scree::drivers
