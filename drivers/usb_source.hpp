#pragma once
// The live source over USB bulk transfers (docs/usb-protocol.md).

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>

#include "core/result.hpp"
#include "drivers/source.hpp"
#include "drivers/stream_frame_reader.hpp"
#include "drivers/usb_protocol.hpp"

namespace scree::drivers {

struct UsbSourceConfig {
  std::uint16_t vendor_id = usb::kVendorId, product_id = usb::kProductId;
  std::string serial;                        ///< "" = any
  std::chrono::milliseconds deadline{2000};  ///< nothing good for this long: the stream is restarted, then the device
  bool poses_needed = true;                  ///< false: poses come from elsewhere
  Origin origin = Origin::live;              ///< what the frames are unless the device says that it is simulated
};

/// Opens the device at the first question for a frame and again (Retry, or at once when it arrives) whenever it was
/// unplugged, failed or fell silent: that is a notice, never an error, and the stream has no end. Messages and origin
/// as with open_stream. No thread of its own: next() handles libusb's events (libusb itself has one for hotplug).
/// next() takes longer than its timeout while it opens, restarts or closes a device that does not answer: 0.5 s for
/// each request and for each wait for cancelled transfers, up to 5 s where the kernel asks for us (clear halt, reset).
/// Errors: unavailable (libusb does not start; this binary was built without it); next(): those of `sensor_for`.
Result<std::unique_ptr<Source>> open_usb(const UsbSourceConfig& config, stream::SensorFor sensor_for);

}  // namespace scree::drivers
