#pragma once
// Which range scanners are on USB: for `scree devices`.

#include <cstdint>
#include <string>
#include <vector>

#include "core/result.hpp"

namespace scree::drivers {

struct UsbDeviceInfo {
  int bus = 0, address = 0;
  std::string node;   ///< /dev/bus/usb/BBB/DDD
  std::string ports;  ///< way through the hubs, as sysfs has it: "1-2.3"
  std::uint16_t vendor_id = 0, product_id = 0;
  std::string product, serial;  ///< "" = the device tells none
  int interface_number = -1;    ///< of the frame stream; −1 = none
  std::string speed;            ///< "5000 Mbit/s"; "unknown"
  std::string why_not;          ///< "" = usable; else expected and found
  bool usable() const { return why_not.empty(); }
};

/// Devices that have the interface of a range scanner or its default vendor and product number, by bus and address.
/// Each is opened and its interface claimed for a moment, which tells whether it could be used; one that is in use is
/// not disturbed. A few milliseconds. Errors: unavailable (libusb does not start; this binary was built without it).
Result<std::vector<UsbDeviceInfo>> list_usb_scanners();

}  // namespace scree::drivers
