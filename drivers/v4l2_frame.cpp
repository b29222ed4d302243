#include "drivers/v4l2_frame.hpp"

#include <utility>

#include "drivers/stream_words.hpp"

namespace scree::drivers::v4l2 {

Status FrameMaker::fit(const Image& image) {
  if (projection_ && projection_->rows == image.rows && projection_->columns == image.columns) return {};
  auto projection = make_projection(configured_.projection, image.rows, image.columns);
  if (!projection) return Error{ErrorKind::bad_config, projection.error().message};
  projection_ = *std::move(projection);
  SensorConfig sensor = configured_;
  sensor.projection = projection_->config;
  sensor_ = std::make_shared<const SensorConfig>(std::move(sensor));
  return {};
}

bool FrameMaker::fill(const Buffer& buffer, const Image& image, RangeFrame& frame) {
  frame.projection = projection_;
  frame.sensor = sensor_;
  read_counts(buffer.bytes, image, counts_);
  frame.raw.reshape(image.rows, image.columns);
  frame.reflectance.assign(0, 0, 0);
  frame.range_m.reshape(image.rows, image.columns);
  const stream::RangeLaw law{projection_->range_offset_m.data(), projection_->range_per_count_m.data(),
                             static_cast<std::int32_t>(projection_->config.invalid_raw)};
  const stream::PixelsOut out{frame.range_m.data(), frame.raw.data(), nullptr};
  stream::ranges_of_counts(reinterpret_cast<const std::uint8_t*>(counts_.data()), counts_.size(), law, out);

  const auto now = read_clocks();
  const auto rows = static_cast<std::size_t>(image.rows);
  const Duration row_period = sensor_->row_period;
  MonotonicTime stamp = buffer.monotonic ? buffer.stamp : now.monotonic;
  // what comes with the last pixel, as an arrival does, is the last row's
  if (buffer.end_of_frame || !buffer.monotonic) stamp -= row_period * static_cast<std::int64_t>(rows - 1);
  frame.received = now.monotonic;
  frame.time = clock_.unix_time(stamp, now);
  frame.row_time.resize(rows);
  for (std::size_t r = 0; r < rows; ++r) frame.row_time[r] = frame.time + row_period * static_cast<std::int64_t>(r);
  frame.T_map_body.assign(rows, Pose{});  // poses come from elsewhere
  frame.pose_variance = {};
  return buffer.monotonic;
}

}  // namespace scree::drivers::v4l2
