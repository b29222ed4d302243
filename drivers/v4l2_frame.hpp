#pragma once
// Buffers of a V4L2 device → range frames.

#include <cstdint>
#include <memory>

#include "core/result.hpp"
#include "drivers/frame/range_frame.hpp"
#include "drivers/v4l2_device.hpp"
#include "drivers/v4l2_image.hpp"

namespace scree::drivers::v4l2 {

/// Keeps the tables and the clock from one buffer, and one opening of the device, to the next. One thread.
class FrameMaker {
 public:
  explicit FrameMaker(SensorConfig configured) : configured_(std::move(configured)) {}

  /// Makes the tables for images of that size, unless they are there. Errors: bad_config, where the sensor that was
  /// configured cannot have such images.
  Status fit(const Image& image);

  /// Fills everything but the sequence. `buffer` holds image.bytes(), `image` is that of the last fit(). False where
  /// the driver does not stamp by the monotonic clock: then the frame has the time of its arrival. No allocation when
  /// the frame is of that size already.
  bool fill(const Buffer& buffer, const Image& image, RangeFrame& frame);

  const StampClock& clock() const { return clock_; }

 private:
  SensorConfig configured_;
  std::shared_ptr<const Projection> projection_;
  std::shared_ptr<const SensorConfig> sensor_;
  Grid<std::uint16_t> counts_;  ///< of the buffer at hand, rows without padding
  StampClock clock_;
};

}  // namespace scree::drivers::v4l2
