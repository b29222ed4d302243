// In place of the other usb_*.cpp in a build without libusb.

#include "drivers/usb_devices.hpp"
#include "drivers/usb_source.hpp"

namespace scree::drivers {
namespace {

Error absent() {
  return {ErrorKind::unavailable,
          "usb: expected a binary with USB, found one that was built without it (SCREE_WITH_USB)"};
}

}  // namespace

Result<std::unique_ptr<Source>> open_usb(const UsbSourceConfig&, stream::SensorFor) {
  return absent();
}

Result<std::vector<UsbDeviceInfo>> list_usb_scanners() {
  return absent();
}

}  // namespace scree::drivers
