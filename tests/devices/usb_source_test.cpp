// The USB source against usbfs as umockdev makes it: libusb, hotplug and asynchronous transfers are the real ones.

#include "drivers/usb_source.hpp"

#include <gtest/gtest.h>

#include "tests/devices/usb_fixture.hpp"

namespace scree::drivers {
namespace {

using std::chrono::milliseconds;

TEST_F(UsbTest, AFrameArrives) {
  scanner_.plug();
  open_source();
  expect_notice("connected");
  scanner_.send(message(0));
  expect_frame(0);
}

}  // namespace
}  // namespace scree::drivers
