#pragma once
// What a V4L2 device says that it is and offers.

#include <cstdint>
#include <string>
#include <vector>

#include "core/result.hpp"
#include "drivers/v4l2_handle.hpp"

namespace scree::drivers::v4l2 {

/// One size, or all from the smallest to the largest where the largest is another.
struct FrameSize {
  int rows = 0, columns = 0;
  int max_rows = 0, max_columns = 0;
  std::vector<double> rates_hz;  ///< at the largest size, fastest first; two ends where `any_rate`
  bool any_rate = false;         ///< every rate between the two
};

struct FormatOffer {
  std::uint32_t fourcc = 0;
  std::string description;
  std::vector<FrameSize> sizes;
};

struct Capabilities {
  std::string driver, card, bus;
  bool capture = false;    ///< video capture with single-planar buffers
  bool streaming = false;  ///< buffers that can be mapped
  std::vector<FormatOffer> formats;
};

/// Asks the device: some ten to a hundred ioctls. Errors as Handle::open, also for a file that is no V4L2 device.
Result<Capabilities> read_capabilities(const Handle& handle, const std::string& path);

/// "Z16 640 x 480 at 30, 15 Hz; …" (columns x rows), for messages; "no formats".
std::string offers_text(const std::vector<FormatOffer>& formats);

/// Why the source cannot use such a device; empty where it can.
std::string why_unusable(const Capabilities& capabilities);

}  // namespace scree::drivers::v4l2
