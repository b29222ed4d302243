#pragma once
// The framing of range frames in a byte stream (docs/frame-stream.md has the offset tables): headers, and the way out.
// The way in: frame_stream_decoder.hpp takes the stream apart, stream_frame_reader.hpp makes frames of the messages.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/grid.hpp"
#include "core/result.hpp"
#include "drivers/frame/pose_track.hpp"
#include "drivers/frame/range_frame.hpp"
#include "drivers/frame/sensor.hpp"

namespace scree::drivers::stream {

inline constexpr std::array<std::uint8_t, 4> kMagic{0x53, 0x43, 0x46, 0xD3};
inline constexpr std::size_t kHeaderBytes = 48;
inline constexpr std::uint8_t kVersionMajor = 1;
inline constexpr std::uint8_t kFlagSimulated = 1;
inline constexpr std::size_t kGeometryBytes = 248;  ///< then the angles
inline constexpr std::size_t kFrameBytes = 32;      ///< then stamps, poses, words
inline constexpr std::size_t kPoseBytes = 64;
inline constexpr std::size_t kDeviceBytes = 32;
inline constexpr int kMaxSide = 4096;
inline constexpr std::int64_t kMaxPixels = std::int64_t{1} << 22;
inline constexpr std::size_t kMaxPoses = 4096;
inline constexpr std::size_t kMaxPayloadBytes = std::size_t{17} << 20;
inline constexpr std::uint16_t kRangeBits = 0x0FFF;  ///< of a 4-byte word, and of Perceptron words
inline constexpr Duration kMaxTime = std::chrono::seconds(4'000'000'000);
inline constexpr double kMaxCoordinate_m = 1e8;

enum class MessageType : std::uint8_t { geometry = 1, frame = 2 };

struct Header {
  std::uint8_t version_minor = 0;
  MessageType type = MessageType::frame;  ///< other values are carried through
  bool simulated = false;
  std::uint32_t payload_bytes = 0;
  std::uint32_t payload_crc = 0;
  std::uint64_t boot_id = 0;
  std::uint64_t sequence = 0;
  std::uint32_t geometry_id = 0;
};

/// What a device says of itself: a complete projection; of the filter, the range limits alone.
struct Geometry {
  SensorConfig sensor;
  int word_bytes = 2;  ///< 4: with reflectance, at sensor.projection.reflectance_shift
  std::string device;
};

/// One frame on its way out. All that it refers to outlives the call.
struct OutgoingFrame {
  std::uint64_t sequence = 0;
  std::span<const Time> row_time;
  std::span<const StampedPose> poses;  ///< around the times of all rows, or none
  PoseVariance variance;
  const Grid<std::uint16_t>& raw;
  const Grid<std::uint16_t>& reflectance;  ///< not read with word_bytes 2
};

/// Writes GEOMETRY and FRAME messages.
class Encoder {
 public:
  /// Errors: usage (a cloud, an incomplete projection, more pixels than a stream carries, a name that it cannot carry,
  /// word_bytes that contradict the reflectance_shift).
  static Result<Encoder> make(const Geometry& geometry, std::uint64_t boot_id, bool simulated);

  /// GEOMETRY and the frame, in place of what `out` held. No allocation once `out` was as large. Errors: internal
  /// (sizes, times or values that the format cannot hold).
  Status encode(const OutgoingFrame& frame, std::vector<std::uint8_t>& out) const;

  const std::vector<std::uint8_t>& geometry_payload() const { return geometry_; }

 private:
  Encoder() = default;
  Status check(const OutgoingFrame& frame) const;
  void put_frame(const OutgoingFrame& frame, std::span<std::uint8_t> payload) const;
  std::size_t append_header(MessageType type, std::uint64_t sequence, std::size_t payload_bytes,
                            std::vector<std::uint8_t>& out) const;
  void seal(std::size_t header_at, std::vector<std::uint8_t>& out) const;

  std::vector<std::uint8_t> geometry_;
  std::uint64_t boot_id_ = 0;
  std::uint32_t geometry_id_ = 0;
  bool simulated_ = false;
  int rows_ = 0, columns_ = 0, word_bytes_ = 2, reflectance_shift_ = 0;
  std::uint16_t largest_ = kRangeBits;
};

/// The payload of GEOMETRY. `geometry` must be valid (Encoder::make checks it).
std::vector<std::uint8_t> encode_geometry(const Geometry& geometry);

/// And back, with a complete projection. Bytes behind it are refused unless `version_minor` > 0. Errors: bad_data
/// "GEOMETRY: expected …, found …".
Result<Geometry> decode_geometry(std::span<const std::uint8_t> payload, std::uint8_t version_minor);

/// The 48 bytes of `header`, its CRC included.
void write_header(const Header& header, std::span<std::uint8_t> out);

}  // namespace scree::drivers::stream
