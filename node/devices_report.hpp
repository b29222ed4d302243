#pragma once
// What `scree devices` tells: lines for people, JSON for programs.

#include <string>
#include <vector>

#include "drivers/usb_devices.hpp"
#include "drivers/v4l2_devices.hpp"

namespace scree::node {

/// Everything that is connected.
struct ConnectedDevices {
  std::vector<drivers::V4l2DeviceInfo> v4l2;
  std::vector<drivers::UsbDeviceInfo> usb;
  std::string usb_error;  ///< why nothing is known of USB; mostly empty
};

/// One paragraph a device; one line where there is none.
std::string devices_text(const ConnectedDevices& devices);

/// {"v4l2": […], "usb": […], "usb_error": ""}, see docs/devices.md.
std::string devices_json(const ConnectedDevices& devices);

}  // namespace scree::node
