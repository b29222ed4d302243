#pragma once
// Which V4L2 devices are connected, for those who choose one.

#include <string>
#include <vector>

#include "drivers/v4l2_capabilities.hpp"

namespace scree::drivers {

struct V4l2DeviceInfo {
  std::string path;    ///< /dev/videoN
  std::string stable;  ///< a link of /dev/v4l/by-id to it, which does not depend on the order of plugging; or empty
  v4l2::Capabilities capabilities;  ///< empty where the device cannot be opened
  std::string reason;               ///< why the V4L2 source cannot use it, and what may help; empty = it can
};

/// All nodes /dev/video*, in the order of their numbers, also those that cannot be opened or are no capture devices.
/// Opens each and asks it, without disturbing who uses it. Cost: some ms a device.
std::vector<V4l2DeviceInfo> list_v4l2_devices();

}  // namespace scree::drivers
