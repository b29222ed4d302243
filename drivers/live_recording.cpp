#include "drivers/live_recording.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <utility>
#include <vector>

namespace scree::drivers {
namespace {

Error unfit(const RangeFrame& frame, const std::string& expected, const std::string& found) {
  return {ErrorKind::bad_data,
          fmt::format("recording of frame {}: expected {}, found {}", frame.sequence, expected, found)};
}

RecordingDescription description_of(const MappedFrame& mapped) {
  RecordingDescription description{mapped.origin, *mapped.frame.sensor};
  description.sensor.projection = mapped.frame.projection->config;
  return description;
}

bool same(const Pose& a, const Pose& b) {
  return a.translation_m == b.translation_m && a.rotation.coeffs() == b.rotation.coeffs();
}

std::string seconds(Time time) {
  return format_seconds(time.time_since_epoch());
}

}  // namespace

Status LiveRecording::begin(const MappedFrame& mapped) {
  origin_ = mapped.origin;
  description_ = describe_(description_of(mapped));
  auto writer = RecordingWriter::create(directory_, description_, PoseErrors::recorded);
  if (!writer) return writer.error();
  writer_ = *std::move(writer);
  sensor_ = mapped.frame.sensor;
  projection_ = mapped.frame.projection;
  return {};
}

/// Whether the format can hold the frame behind those before it.
Status LiveRecording::check(const MappedFrame& mapped) {
  const RangeFrame& frame = mapped.frame;
  if (frame.raw.rows() != frame.range_m.rows() || frame.raw.columns() != frame.range_m.columns())
    return unfit(frame, "the counts of an image", "a frame of points alone");
  if (!writer_) return {};
  if (frame.sensor != sensor_ || frame.projection != projection_) {  // opened again, or another one
    if (describe_({origin_, description_of(mapped).sensor}) != description_)
      return unfit(frame, "the sensor of the frames before it", "another one");
    sensor_ = frame.sensor;
    projection_ = frame.projection;
  }
  if (const auto last = writer_->last_frame(); last && frame.time <= *last)
    return unfit(frame, "a time above " + seconds(*last) + " s", seconds(frame.time) + " s");
  if (const auto last = writer_->last_pose(); last && frame.time <= *last)
    return unfit(frame, "rows behind those of the frame before, which end at " + seconds(*last) + " s",
                 seconds(frame.time) + " s");
  return {};
}

Status LiveRecording::add_poses(const MappedFrame& mapped) {
  const RangeFrame& frame = mapped.frame;
  const Duration period = frame.sensor->row_period;
  const bool one_instant = period == Duration::zero();
  std::vector<StampedPose> poses;
  bool restamped = false;
  for (std::size_t r = 0; r < mapped.T_map_body.size(); ++r) {
    const Time time = frame.time + period * static_cast<std::int64_t>(r);
    restamped = restamped || frame.row_time[r] != time;
    if (one_instant && r > 0) {
      if (!same(mapped.T_map_body[r], mapped.T_map_body[0]))
        return unfit(frame, "one pose for a frame that is taken at one instant", "others");
      continue;
    }
    poses.push_back({time, mapped.T_map_body[r]});
  }
  restamped_ += restamped ? 1U : 0U;
  return writer_->add_poses(poses, mapped.pose_variance);
}

/// Returns that the reader of the frames removed for their reflectance are removed again by who reads the recording;
/// where the file has no place for the reflectance they become "no return".
Status LiveRecording::add_image(const RangeFrame& frame) {
  const ProjectionConfig& projection = projection_->config;
  file_.raw = frame.raw;
  const bool perceptron = is_perceptron(projection.kind);
  const bool with_reflectance = perceptron && frame.reflectance.size() > 0 && projection.reflectance_shift != 0;
  if (!with_reflectance && sensor_->filter.min_reflectance > 0) {
    for (std::size_t i = 0; i < file_.raw.size(); ++i) {
      if (!std::isnan(frame.range_m[i]) || file_.raw[i] == projection.invalid_raw) continue;
      if (projection.invalid_raw < 0) return unfit(frame, "a count that means no return", "none (invalid_raw)");
      file_.raw[i] = static_cast<std::uint16_t>(projection.invalid_raw);
    }
  }
  if (!perceptron) return writer_->add_raw_frame(projection.kind, file_.raw, frame.time, frame.sequence);
  file_.layout = projection.kind == ProjectionKind::perceptron_cmu ? RangeFileLayout::cmu_words : RangeFileLayout::usf;
  file_.reflectance = with_reflectance ? frame.reflectance : Grid<std::uint16_t>();
  return writer_->add_range_file(file_, with_reflectance ? projection.reflectance_shift : 0, frame.time,
                                 frame.sequence);
}

Status LiveRecording::add(const MappedFrame& mapped) {
  if (const auto fit = check(mapped); !fit) return fit;
  if (!writer_)
    if (const auto begun = begin(mapped); !begun) return begun;
  if (const auto put = add_poses(mapped); !put) return put;
  return add_image(mapped.frame);
}

Status LiveRecording::finish() {
  return writer_ ? writer_->finish() : Status{};
}

}  // namespace scree::drivers
