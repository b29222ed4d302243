#pragma once
// The live source over a byte stream (docs/frame-stream.md).

#include <chrono>
#include <memory>
#include <string>

#include "core/result.hpp"
#include "drivers/source.hpp"
#include "drivers/stream_frame_reader.hpp"

namespace scree::drivers {

struct StreamSourceConfig {
  std::string address;                       ///< see parse_stream_address
  std::chrono::milliseconds deadline{2000};  ///< nothing good for this long: the connection is given up
  bool poses_needed = true;                  ///< false: poses come from elsewhere
  Origin origin = Origin::live;              ///< what the frames are unless the device says that it is simulated
};

/// Connects at the first question for a frame and again (Retry) whenever the connection is lost or falls silent: that
/// is a notice, never an error, and the stream has no end. A message that was refused is Kind::skipped. From the first
/// simulated frame on the origin is sim (hil stays hil) for good. Errors: usage (the address); next(): those of
/// `sensor_for`.
Result<std::unique_ptr<Source>> open_stream(const StreamSourceConfig& config, stream::SensorFor sensor_for);

}  // namespace scree::drivers
