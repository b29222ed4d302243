#pragma once
// What `scree devices` tells: lines for people, JSON for programs.

#include <string>
#include <vector>

#include "drivers/v4l2_devices.hpp"

namespace scree::node {

/// Everything that is connected. USB scanners join here.
struct ConnectedDevices {
  std::vector<drivers::V4l2DeviceInfo> v4l2;
};

/// One paragraph a device; one line where there is none.
std::string devices_text(const ConnectedDevices& devices);

/// {"v4l2": […], "usb": […]}, see docs/devices.md.
std::string devices_json(const ConnectedDevices& devices);

}  // namespace scree::node
