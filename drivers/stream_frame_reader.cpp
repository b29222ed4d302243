#include "drivers/stream_frame_reader.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <utility>

#include "drivers/little_endian.hpp"
#include "drivers/stream_words.hpp"

namespace scree::drivers::stream {
namespace {

bool in_time(Time time) {
  return time.time_since_epoch() <= kMaxTime && time.time_since_epoch() >= -kMaxTime;
}

std::string seconds(Time time) {
  return format_seconds(time.time_since_epoch()) + " s";
}

}  // namespace

Result<Taken> FrameReader::take(const Message& message, RangeFrame& frame) {
  Result<Taken> taken = Taken::ignored_type;
  if (message.header.type == MessageType::geometry)
    taken = take_geometry(message);
  else if (message.header.type == MessageType::frame)
    taken = take_frame(message, frame);
  else
    refuse("type", "1 or 2", fmt::to_string(static_cast<int>(message.header.type)));
  if (taken) ++counts_[static_cast<std::size_t>(*taken)];
  return taken;
}

Result<Taken> FrameReader::take_geometry(const Message& message) {
  const std::uint32_t id = message.header.payload_crc;
  if (geometry_id_ == id) return Taken::geometry;
  geometry_id_.reset();
  geometry_fault_.clear();
  auto told = decode_geometry(message.payload, message.header.version_minor);
  if (!told) {
    geometry_fault_ = reason_ = told.error().message;
    return Taken::bad_geometry;
  }
  auto sensor = sensor_for_(told->sensor);
  if (!sensor && taken(Taken::frame) > 0) {  // it was the right device before: what it says now is its fault
    geometry_fault_ = reason_ = sensor.error().message;
    return Taken::bad_geometry;
  }
  if (!sensor) return sensor.error();
  const ProjectionConfig& image = told->sensor.projection;
  auto projection = make_projection(sensor->projection, image.rows, image.columns);
  if (!projection) return Error{ErrorKind::bad_config, projection.error().message};
  projection_ = *std::move(projection);
  sensor->projection = projection_->config;
  sensor_ = std::make_shared<const SensorConfig>(*std::move(sensor));
  word_bytes_ = told->word_bytes;
  reflectance_shift_ = image.reflectance_shift;
  device_ = std::move(told->device);
  geometry_id_ = id;
  return Taken::geometry;
}

Taken FrameReader::take_frame(const Message& message, RangeFrame& frame) {
  if (geometry_id_ != message.header.geometry_id) {
    refuse("geometry_id", geometry_id_ ? fmt::format("{:08x}", *geometry_id_) : "a GEOMETRY before",
           fmt::format("{:08x}", message.header.geometry_id));
    if (!geometry_fault_.empty()) reason_ = geometry_fault_;  // why there is none
    return Taken::no_geometry;
  }
  if (!read_shape(message.payload, message.header.version_minor) || !read_times(frame) || !read_poses())
    return Taken::bad_frame;
  if (!place_rows(frame)) return Taken::no_pose;
  if (!read_words(frame)) return Taken::bad_frame;
  frame.projection = projection_;
  frame.sensor = sensor_;
  frame.sequence = message.header.sequence;
  frame.pose_variance = poses_needed_ ? variance_ : PoseVariance{};
  note_sequence(message.header);
  return Taken::frame;
}

bool FrameReader::read_shape(std::span<const std::uint8_t> payload, std::uint8_t version_minor) {
  if (payload.size() < kFrameBytes)
    return refuse("payload", fmt::format("at least {} bytes", kFrameBytes), fmt::to_string(payload.size()));
  ByteReader in(payload);
  const int rows = in.take<std::uint16_t>(), columns = in.take<std::uint16_t>();
  const int word_bytes = in.take<std::uint8_t>();
  in.skip(1);
  const std::size_t poses = in.take<std::uint16_t>();
  if (rows != projection_->rows || columns != projection_->columns || word_bytes != word_bytes_)
    return refuse("image",
                  fmt::format("{} x {} words of {} bytes", projection_->rows, projection_->columns, word_bytes_),
                  fmt::format("{} x {} of {}", rows, columns, word_bytes));
  if (poses > kMaxPoses) return refuse("poses", fmt::format("at most {}", kMaxPoses), fmt::to_string(poses));
  const std::size_t times_bytes = 8 * static_cast<std::size_t>(rows);
  const std::size_t words_bytes = projection_->range_offset_m.size() * static_cast<std::size_t>(word_bytes);
  const std::size_t bytes = kFrameBytes + times_bytes + kPoseBytes * poses + words_bytes;
  if (payload.size() < bytes || (version_minor == 0 && payload.size() > bytes))
    return refuse("payload", fmt::format("{} bytes", bytes), fmt::to_string(payload.size()));
  for (Eigen::Vector3d* part : {&variance_.position_m2, &variance_.attitude_rad2})
    for (int axis = 0; axis < 3; ++axis) {
      const auto value = in.take<float>();
      if (!(value >= 0.0F && value <= 1e12F)) return refuse("variance", "0 or more", fmt::to_string(value));
      (*part)[axis] = static_cast<double>(value);
    }
  times_ = payload.subspan(kFrameBytes, times_bytes);
  poses_bytes_ = payload.subspan(kFrameBytes + times_bytes, kPoseBytes * poses);
  words_ = payload.subspan(kFrameBytes + times_bytes + kPoseBytes * poses, words_bytes);
  return true;
}

bool FrameReader::read_times(RangeFrame& frame) {
  const auto rows = static_cast<std::size_t>(projection_->rows);
  frame.row_time.resize(rows);
  ByteReader in(times_);
  for (std::size_t r = 0; r < rows; ++r) {
    const Time time(Duration(in.take<std::int64_t>()));
    if (!in_time(time) || (r > 0 && time < frame.row_time[r - 1]))
      return refuse("row times", "Unix times that do not decrease", fmt::format("{} at row {}", seconds(time), r));
    frame.row_time[r] = time;
  }
  frame.time = frame.row_time.front();
  return true;
}

bool FrameReader::read_poses() {
  poses_.clear();
  if (!poses_needed_) return true;
  ByteReader in(poses_bytes_);
  for (std::size_t left = poses_bytes_.size() / kPoseBytes; left > 0; --left) {
    StampedPose pose;
    pose.time = Time(Duration(in.take<std::int64_t>()));
    Eigen::Vector3d& t = pose.T_map_body.translation_m;
    for (int axis = 0; axis < 3; ++axis) t[axis] = in.take<double>();
    const auto x = in.take<double>(), y = in.take<double>(), z = in.take<double>(), w = in.take<double>();
    const Eigen::Quaterniond q(w, x, y, z);
    if (!(t.allFinite() && t.cwiseAbs().maxCoeff() <= kMaxCoordinate_m && std::abs(q.norm() - 1.0) <= 1e-3))
      return refuse("pose", "metres within 1e8 and a quaternion of norm 1",
                    fmt::format("({}, {}, {}), norm {}", t.x(), t.y(), t.z(), q.norm()));
    if (!in_time(pose.time) || (!poses_.empty() && pose.time <= poses_.back().time))
      return refuse("pose times", "increasing Unix times", seconds(pose.time));
    pose.T_map_body.rotation = q;
    normalise(pose.T_map_body);  // as PoseTrack does it: a recording of the frame gives the same bits
    poses_.push_back(pose);
  }
  return true;
}

/// The rows' poses, as PoseTrack::at would have them.
bool FrameReader::place_rows(RangeFrame& frame) {
  const auto& times = frame.row_time;
  frame.T_map_body.resize(times.size());
  if (!poses_needed_) {
    std::fill(frame.T_map_body.begin(), frame.T_map_body.end(), Pose{});
    return true;
  }
  if (poses_.empty())
    return refuse("poses", "poses in the frame, or pose.source udp or static in the configuration", "none");
  if (times.front() < poses_.front().time || times.back() > poses_.back().time)
    return refuse("poses", fmt::format("poses from {} to {}", seconds(times.front()), seconds(times.back())),
                  fmt::format("{} to {}", seconds(poses_.front().time), seconds(poses_.back().time)));
  std::size_t after = 0;
  for (std::size_t r = 0; r < times.size(); ++r) {
    while (after < poses_.size() && poses_[after].time <= times[r]) ++after;
    const StampedPose& before = poses_[after - 1];  // the first pose is not after the first row
    if (before.time == times[r]) {
      frame.T_map_body[r] = before.T_map_body;
      continue;
    }
    if (PoseTrack::is_gap(before, poses_[after]))
      return refuse("poses", "poses at most 1 s apart, or equal ones",
                    fmt::format("{} and {}", seconds(before.time), seconds(poses_[after].time)));
    frame.T_map_body[r] = interpolate(before, poses_[after], times[r]);
  }
  return true;
}

bool FrameReader::read_words(RangeFrame& frame) {
  const int rows = projection_->rows, columns = projection_->columns;
  const bool reflects = word_bytes_ == 4;
  frame.range_m.reshape(rows, columns);
  frame.raw.reshape(rows, columns);
  frame.reflectance.reshape(reflects ? rows : 0, reflects ? columns : 0);
  const RangeLaw law{projection_->range_offset_m.data(), projection_->range_per_count_m.data(),
                     static_cast<std::int32_t>(projection_->config.invalid_raw)};
  const PixelsOut out{frame.range_m.data(), frame.raw.data(), frame.reflectance.data()};
  const std::size_t pixels = frame.range_m.size();
  if (reflects) {
    ranges_of_words(words_.data(), pixels, law, reflectance_shift_,
                    static_cast<std::uint32_t>(sensor_->filter.min_reflectance), out);
    return true;
  }
  const std::uint16_t any = ranges_of_counts(words_.data(), pixels, law, out);
  if (any <= kRangeBits || !is_perceptron(projection_->config.kind)) return true;
  return refuse("words", "counts of 0 … 4095", "a larger one");
}

void FrameReader::note_sequence(const Header& header) {
  if (boot_id_ == header.boot_id && header.sequence > sequence_) missing_ += header.sequence - sequence_ - 1;
  boot_id_ = header.boot_id;
  sequence_ = header.sequence;
}

/// Always false.
bool FrameReader::refuse(const char* what, const std::string& expected, const std::string& found) {
  reason_ = fmt::format("{}: expected {}, found {}", what, expected, found);
  return false;
}

}  // namespace scree::drivers::stream
