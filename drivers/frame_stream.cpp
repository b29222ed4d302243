#include "drivers/frame_stream.hpp"

#include <algorithm>
#include <fmt/format.h>

#include "drivers/checksum.hpp"
#include "drivers/little_endian.hpp"

namespace scree::drivers::stream {
namespace {

Error refused(ErrorKind kind, std::string_view what, const std::string& expected, const std::string& found) {
  return {kind, fmt::format("frame stream: {}: expected {}, found {}", what, expected, found)};
}

bool is_name(const std::string& text) {
  return !text.empty() && text.size() < kDeviceBytes &&
         std::all_of(text.begin(), text.end(), [](char c) { return c >= ' ' && c < 127; });
}

Status check_geometry(const Geometry& geometry) {
  const ProjectionConfig& p = geometry.sensor.projection;
  const auto wrong = [](std::string_view what, const std::string& expected, const std::string& found) {
    return refused(ErrorKind::usage, what, expected, found);
  };
  if (p.kind == ProjectionKind::cloud) return wrong("projection", "an image", "cloud");
  if (p.rows < 1 || p.rows > kMaxSide || p.columns < 1 || p.columns > kMaxSide ||
      std::int64_t{p.rows} * p.columns > kMaxPixels)
    return wrong("image", fmt::format("1 … {} rows and columns, at most {} pixels", kMaxSide, kMaxPixels),
                 fmt::format("{} x {}", p.rows, p.columns));
  if (const auto complete = complete_projection(p, p.rows, p.columns); !complete) return complete.error();
  if (p.trusted_rows < 1 || p.ambiguity_m < 0.0) return wrong("projection", "a complete one", "defaults to be filled");
  const bool fits =
      geometry.word_bytes == 2 ? p.reflectance_shift == 0 : geometry.word_bytes == 4 && p.reflectance_shift != 0;
  if (!fits)
    return wrong("words", "2 bytes without reflectance_shift or 4 with it",
                 fmt::format("{} bytes, shift {}", geometry.word_bytes, p.reflectance_shift));
  if (!is_name(geometry.device)) return wrong("device", "1 … 31 visible ASCII characters", geometry.device);
  return {};
}

void put_range_words(const Grid<std::uint16_t>& raw, std::uint8_t* out) {
  std::memcpy(out, raw.data(), 2 * raw.size());
}

void put_full_words(const Grid<std::uint16_t>& raw, const Grid<std::uint16_t>& reflectance, int shift,
                    std::uint8_t* out) {
  for (std::size_t i = 0; i < raw.size(); ++i) {
    const std::uint32_t word = raw[i] | static_cast<std::uint32_t>(reflectance[i]) << shift;
    std::memcpy(out + 4 * i, &word, 4);
  }
}

void put_pose(const StampedPose& pose, ByteWriter& out) {
  const Eigen::Vector3d& t = pose.T_map_body.translation_m;
  const Eigen::Quaterniond& q = pose.T_map_body.rotation;
  out.put(std::int64_t{pose.time.time_since_epoch().count()});
  for (const double value : {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()}) out.put(value);
}

std::uint16_t largest(const Grid<std::uint16_t>& grid) {
  std::uint16_t value = 0;
  for (const std::uint16_t item : grid) value = std::max(value, item);
  return value;
}

}  // namespace

void write_header(const Header& header, std::span<std::uint8_t> out) {
  ByteWriter writer(out);
  for (const std::uint8_t byte : kMagic) writer.put(byte);
  writer.put(kVersionMajor);
  writer.put(header.version_minor);
  writer.put(static_cast<std::uint8_t>(header.type));
  writer.put(static_cast<std::uint8_t>(header.simulated ? kFlagSimulated : 0));
  writer.put(header.payload_bytes);
  writer.put(header.payload_crc);
  writer.put(header.boot_id);
  writer.put(header.sequence);
  writer.put(header.geometry_id);
  writer.fill(8);
  writer.put(crc32_of(out.first(kHeaderBytes - 4)));
}

Result<Encoder> Encoder::make(const Geometry& geometry, std::uint64_t boot_id, bool simulated) {
  if (const auto valid = check_geometry(geometry); !valid) return valid.error();
  const ProjectionConfig& p = geometry.sensor.projection;
  Encoder encoder;
  encoder.geometry_ = encode_geometry(geometry);
  encoder.geometry_id_ = crc32_of(encoder.geometry_);
  encoder.boot_id_ = boot_id;
  encoder.simulated_ = simulated;
  encoder.rows_ = p.rows;
  encoder.columns_ = p.columns;
  encoder.word_bytes_ = geometry.word_bytes;
  encoder.reflectance_shift_ = p.reflectance_shift;
  const bool depth = p.kind == ProjectionKind::pinhole || p.kind == ProjectionKind::spherical;
  if (depth && geometry.word_bytes == 2) encoder.largest_ = 0xFFFF;
  return encoder;
}

/// What the format cannot hold.
Status Encoder::check(const OutgoingFrame& frame) const {
  const auto wrong = [](std::string_view what, std::size_t expected, std::size_t found) {
    return refused(ErrorKind::internal, what, fmt::to_string(expected), fmt::to_string(found));
  };
  const auto rows = static_cast<std::size_t>(rows_);
  const std::size_t pixels = rows * static_cast<std::size_t>(columns_);
  if (frame.raw.rows() != rows_ || frame.raw.size() != pixels) return wrong("pixels", pixels, frame.raw.size());
  if (frame.row_time.size() != rows) return wrong("row times", rows, frame.row_time.size());
  if (frame.poses.size() > kMaxPoses) return wrong("poses of at most", kMaxPoses, frame.poses.size());
  if (largest(frame.raw) > largest_) return wrong("counts of at most", largest_, largest(frame.raw));
  if (word_bytes_ == 4 && (frame.reflectance.size() != pixels || largest(frame.reflectance) > kRangeBits))
    return wrong("reflectances up to 4095 in number", pixels, frame.reflectance.size());
  return {};
}

Status Encoder::encode(const OutgoingFrame& frame, std::vector<std::uint8_t>& out) const {
  if (auto possible = check(frame); !possible) return possible;
  out.clear();
  const std::size_t geometry_at = append_header(MessageType::geometry, frame.sequence, geometry_.size(), out);
  std::copy(geometry_.begin(), geometry_.end(), out.begin() + static_cast<std::ptrdiff_t>(geometry_at + kHeaderBytes));
  seal(geometry_at, out);
  const std::size_t words_at = kFrameBytes + 8 * frame.row_time.size() + kPoseBytes * frame.poses.size();
  const std::size_t bytes = words_at + frame.raw.size() * static_cast<std::size_t>(word_bytes_);
  const std::size_t frame_at = append_header(MessageType::frame, frame.sequence, bytes, out);
  const auto payload = std::span(out).subspan(frame_at + kHeaderBytes);
  put_frame(frame, payload);
  if (word_bytes_ == 2)
    put_range_words(frame.raw, payload.data() + words_at);
  else
    put_full_words(frame.raw, frame.reflectance, reflectance_shift_, payload.data() + words_at);
  seal(frame_at, out);
  return {};
}

/// All but the words.
void Encoder::put_frame(const OutgoingFrame& frame, std::span<std::uint8_t> payload) const {
  ByteWriter writer(payload);
  writer.put(static_cast<std::uint16_t>(rows_));
  writer.put(static_cast<std::uint16_t>(columns_));
  writer.put(static_cast<std::uint8_t>(word_bytes_));
  writer.fill(1);
  writer.put(static_cast<std::uint16_t>(frame.poses.size()));
  for (const Eigen::Vector3d* part : {&frame.variance.position_m2, &frame.variance.attitude_rad2})
    for (int axis = 0; axis < 3; ++axis) writer.put(static_cast<float>((*part)[axis]));
  for (const Time time : frame.row_time) writer.put(std::int64_t{time.time_since_epoch().count()});
  for (const StampedPose& pose : frame.poses) put_pose(pose, writer);
}

/// Room for header and payload; the header's numbers but the CRCs.
std::size_t Encoder::append_header(MessageType type, std::uint64_t sequence, std::size_t payload_bytes,
                                   std::vector<std::uint8_t>& out) const {
  const std::size_t at = out.size();
  out.resize(at + kHeaderBytes + payload_bytes);
  Header header;
  header.type = type;
  header.simulated = simulated_;
  header.payload_bytes = static_cast<std::uint32_t>(payload_bytes);
  header.boot_id = boot_id_;
  header.sequence = sequence;
  header.geometry_id = geometry_id_;
  write_header(header, std::span(out).subspan(at));
  return at;
}

/// Both CRCs of the message that begins at `header_at` and ends with `out`.
void Encoder::seal(std::size_t header_at, std::vector<std::uint8_t>& out) const {
  const auto message = std::span(out).subspan(header_at);
  ByteWriter(message.subspan(12)).put(crc32_of(message.subspan(kHeaderBytes)));
  ByteWriter(message.subspan(kHeaderBytes - 4)).put(crc32_of(message.first(kHeaderBytes - 4)));
}

}  // namespace scree::drivers::stream
