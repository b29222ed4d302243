#pragma once
// The bodies of ANNOUNCE, MANIFEST, HEARTBEAT, BYE, POSE and POSE_INPUT (offset tables: docs/protocol.md).
// encode() sets header.type and seals the datagram, with a MAC when given a key; decode() checks a body of the type
// that the header names and returns body_length or body_value. Bytes beyond the known body are refused in 1.0 and
// skipped in later minors.

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/grid.hpp"
#include "core/pose.hpp"
#include "core/time.hpp"
#include "node/protocol_header.hpp"
#include "node/protocol_layers.hpp"

namespace scree::node::protocol {

inline constexpr std::size_t kNameBytes = 32;  ///< with the closing NUL
/// Bounds a receiver's memory; a window of 2048 × 2048 cells touches as many when it is not aligned to tiles.
inline constexpr std::int64_t kMaxWindowTiles = 65 * 65;
inline constexpr Duration kMaxPoseTime = std::chrono::seconds(4'000'000'000);  ///< before and after 1970
inline constexpr double kMaxPoseCoordinate_m = 1e8;
inline constexpr std::size_t kMaxManifestTiles = 256;
inline constexpr std::size_t kMaxSensors = 16;

/// Where the map's origin lies on the Earth (WGS-84), and how the map is turned.
struct GeoAnchor {
  double latitude_deg = 0.0;
  double longitude_deg = 0.0;
  double altitude_m = 0.0;
  double heading_rad = 0.0;  ///< from east to the map's +x, counter-clockwise
  friend bool operator==(const GeoAnchor&, const GeoAnchor&) = default;
};

struct AnnouncedLayer {
  std::uint8_t layer = 0;     ///< number on the wire; a reader skips the ones it does not know
  std::uint8_t encoding = 0;  ///< type of a raw value: 0 u8, 1 i16, 2 u16
  float scale = 1.0f;         ///< the block's own scale and offset are the ones that hold
  float offset = 0.0f;
  friend bool operator==(const AnnouncedLayer&, const AnnouncedLayer&) = default;
};

struct Announce {
  std::uint64_t map_id = 0;
  double resolution_m = 0.0;
  std::optional<GeoAnchor> anchor;
  LatticeWindow window;  ///< in cells; the tile window on the wire is the tiles it touches
  std::uint32_t stale_ms = 300;
  std::uint32_t lost_ms = 1000;
  std::uint32_t cell_max_age_ms = 0;  ///< 0 = no limit
  std::uint32_t refresh_ms = 1000;
  std::uint32_t heartbeat_ms = 100;
  std::string frame_name;  ///< names: UTF-8 without control characters, at most 31 bytes
  std::string node_name;
  std::string software_version;
  std::vector<AnnouncedLayer> layers;
  friend bool operator==(const Announce&, const Announce&) = default;
};

struct Manifest {
  std::int32_t tx0 = 0;
  std::int32_t ty0 = 0;
  std::uint16_t columns = 0;
  std::uint16_t rows = 0;
  std::uint8_t layer = 0;
  std::array<std::uint32_t, kMaxManifestTiles> tile_rev{};  ///< the first columns·rows, rows run +y
};

enum class SensorState : std::uint8_t { waiting = 0, ok = 1, stale = 2, lost = 3 };

struct SensorReport {
  std::uint8_t sensor = 0;
  SensorState state = SensorState::waiting;
  std::uint32_t age_ms = 0;  ///< since its last frame
  friend bool operator==(const SensorReport&, const SensorReport&) = default;
};

struct Heartbeat {
  std::uint64_t uptime_ms = 0;
  std::uint64_t frames_in = 0;
  std::uint64_t frames_dropped = 0;
  std::uint64_t rss_bytes = 0;
  std::uint32_t latency_p50_us = 0;
  std::uint32_t latency_p99_us = 0;
  std::uint32_t latency_max_us = 0;
  std::uint32_t tiles_known = 0;  ///< tiles of the window with at least one known cost
  std::uint8_t sensor_count = 0;
  std::array<SensorReport, kMaxSensors> sensors{};
  friend bool operator==(const Heartbeat&, const Heartbeat&) = default;
};

enum class ByeReason : std::uint8_t {
  finished = 0,  ///< the recording is at its end
  stopped = 1,   ///< the operator stopped the node
  failed = 2,    ///< an error ended it
  restart = 3,   ///< it comes back, with another boot_id
};

struct Bye {
  ByeReason reason = ByeReason::finished;  ///< numbers that are not listed are carried through
};

/// Variances of position (m²: x, y, z) and of small rotations about the map axes (rad²: roll, pitch, yaw); 0 = not
/// stated.
struct PoseInputMessage {
  Time time;  ///< Unix time of the node's clock
  Pose T_map_body;
  std::array<float, 6> variances{};
};

/// The pose that the map took for a frame.
struct PoseMessage {
  Time time;  ///< Unix time at which it held: the frame's middle row
  Pose T_map_body;
  std::array<float, 6> variances{};  ///< as in PoseInputMessage
  std::uint32_t age_us = 0;          ///< since the pose was delivered to the node
};

void encode(Header header, const Announce& message, Datagram& out, const Key* key = nullptr);
void encode(Header header, const Manifest& message, Datagram& out, const Key* key = nullptr);
void encode(Header header, const Heartbeat& message, Datagram& out, const Key* key = nullptr);
void encode(Header header, const Bye& message, Datagram& out, const Key* key = nullptr);
void encode(Header header, const PoseInputMessage& message, Datagram& out, const Key* key = nullptr);
void encode(Header header, const PoseMessage& message, Datagram& out, const Key* key = nullptr);

Reject decode(const Opened& opened, Announce& out);
Reject decode(const Opened& opened, Manifest& out);
Reject decode(const Opened& opened, Heartbeat& out);
Reject decode(const Opened& opened, Bye& out);
Reject decode(const Opened& opened, PoseInputMessage& out);
Reject decode(const Opened& opened, PoseMessage& out);

/// A name that ANNOUNCE can carry: 1 … 31 bytes, no control characters.
bool valid_name(std::string_view name);

/// Fixed part of each body.
inline constexpr std::size_t kAnnounceBytes = 200;  ///< then 12 for each layer
inline constexpr std::size_t kAnnouncedLayerBytes = 12;
inline constexpr std::size_t kManifestBytes = 16;   ///< then 4 for each tile
inline constexpr std::size_t kHeartbeatBytes = 56;  ///< then 8 for each sensor
inline constexpr std::size_t kSensorBytes = 8;
inline constexpr std::size_t kByeBytes = 8;
inline constexpr std::size_t kPoseInputBytes = 88;
inline constexpr std::size_t kPoseBytes = 96;

/// 1.0 bodies end where their type says; a later minor version may append.
bool body_ends_at(const Opened& opened, std::size_t bytes);

}  // namespace scree::node::protocol
