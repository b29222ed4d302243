#pragma once
// The live source over a depth camera's V4L2 device node (docs/devices.md).

#include <chrono>
#include <memory>
#include <string>

#include "core/result.hpp"
#include "drivers/frame/sensor.hpp"
#include "drivers/retry.hpp"
#include "drivers/source.hpp"

namespace scree::drivers {

struct V4l2SourceConfig {
  std::string device = "/dev/video0";        ///< the node, or a link to it (/dev/v4l/by-id/…)
  std::string format;                        ///< Z16, Y16 or Y12; empty = the first of these that the device offers
  double rate_hz = 0.0;                      ///< 0 = the device's own
  std::chrono::milliseconds deadline{2000};  ///< no good frame for this long: the device is closed and opened again
  /// projection pinhole; rows, columns 0 = the device's present size
  SensorConfig sensor{};
  Origin origin = Origin::live;
  std::chrono::milliseconds first_retry = kFirstRetry;  ///< doubled up to a second, from the first again after a frame
};

/// Opens the device at the first question for a frame, and again whenever it is lost, silent, or not to be had: that is
/// a notice, once a loss, never an error, and the stream has no end. What the device refuses (format, size) is a notice
/// too, because another device may be plugged in.
///
/// Every buffer becomes a frame, also when several are ready: converting one takes a fraction of the time between two,
/// and whoever takes the frames drops old ones, with a count, where the newest is wanted. Frames hold metres along the
/// rays, NaN where the count is projection.invalid_raw (0 unless told otherwise), the counts in `raw`, the identity for
/// every pose, and the driver's time stamp as Unix time, strictly increasing. Buffers that the driver flags as
/// corrupt, or that are too short, are Kind::skipped. No allocation of pixels after warm-up.
///
/// Errors: bad_config for what no device can mend: a projection that is not pinhole or not complete, an unknown
/// format, a rate slower than the deadline; next(): the same, where it depends on the size that the device has.
Result<std::unique_ptr<Source>> open_v4l2(const V4l2SourceConfig& config);

}  // namespace scree::drivers
