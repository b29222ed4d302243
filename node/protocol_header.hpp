#pragma once
// The 64 bytes that every datagram begins with (docs/protocol.md).

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "drivers/source.hpp"
#include "node/protocol_mac.hpp"
#include "node/protocol_reject.hpp"

namespace scree::node::protocol {

inline constexpr std::size_t kHeaderBytes = 64;
inline constexpr std::size_t kMaxDatagramBytes = 1200;
inline constexpr std::uint8_t kVersionMajor = 1;
inline constexpr std::uint8_t kVersionMinor = 0;

/// Other values are carried through decode_datagram unchanged.
enum class MessageType : std::uint8_t {
  announce = 1,
  tile = 2,
  manifest = 3,
  heartbeat = 4,
  pose = 5,
  subscribe = 6,
  cookie = 7,
  nack = 8,
  ping = 9,
  pong = 10,
  bye = 11,
  pose_input = 13,
};

/// Bits of Header::flags; bits 4–5 are the origin, bits 6–7 zero (readers ignore them).
enum Flag : std::uint8_t {
  kFlagMac = 1,
  kFlagRefresh = 2,  ///< repeats a block that did not change since it was last sent
  kFlagRepeat = 4,   ///< second and later copies of a message
  kFlagClockLocked = 8,
};

/// Bits of Header::health.
enum Health : std::uint16_t {
  kHealthSensorStale = 1 << 0,
  kHealthSensorLost = 1 << 1,
  kHealthPoseStale = 1 << 2,
  kHealthOverload = 1 << 3,
  kHealthCalibrationMissing = 1 << 4,
  kHealthClockStepped = 1 << 5,
  kHealthReducedResolution = 1 << 6,
  kHealthRecordingFailed = 1 << 7,
  kHealthFault = 1 << 15,  ///< do not drive
};

struct Header {
  std::uint8_t ver_minor = kVersionMinor;
  MessageType type = MessageType::heartbeat;
  std::uint8_t flags = 0;  ///< bits of Flag, without the origin
  drivers::Origin origin = drivers::Origin::live;
  std::uint32_t stream_id = 0;
  std::uint64_t boot_id = 0;
  std::uint64_t seq = 0;
  std::int64_t t_data_ns = 0;  ///< Unix time of the newest sample contained; 0 = no data yet
  std::uint32_t age_us = 0;    ///< monotonic now − acquisition; saturates; 0xFFFFFFFF also for no data yet
  std::uint32_t map_rev = 0;
  std::uint16_t health = 0;
  std::uint16_t cost_profile = 0;
  std::uint32_t config_hash = 0;
  std::uint16_t key_id = 0;

  friend bool operator==(const Header&, const Header&) = default;
};

/// One datagram under construction: the body goes to bytes[64 …], then `seal` writes the header.
struct Datagram {
  std::array<std::uint8_t, kMaxDatagramBytes> bytes{};
  std::size_t size = 0;

  std::span<std::uint8_t> body() { return std::span(bytes).subspan(kHeaderBytes); }
  std::span<const std::uint8_t> view() const { return std::span(bytes).first(size); }
};

/// Writes header, lengths and CRC around a body of `body_bytes` that is already in place, and with a key the MAC behind
/// it; MAC flag and key_id follow from the key alone. Body and MAC must fit.
void seal(const Header& header, std::size_t body_bytes, Datagram& datagram, const Key* key = nullptr);

/// What decode_datagram found; `body` points into the datagram.
struct Opened {
  Header header;
  std::span<const std::uint8_t> body;
};

inline const KeyRing kNoKeys;

/// Checks length, magic, version, total_len, header_len, CRC and MAC in that order. Never reads outside `datagram`.
/// With keys, a datagram must have a MAC of one of them; without, it must have none.
Reject open_datagram(std::span<const std::uint8_t> datagram, Opened& out, const KeyRing& keys = kNoKeys);

/// zlib's CRC-32 of everything before the MAC, with the CRC field taken as zero. At least 64 bytes.
std::uint32_t datagram_crc(std::span<const std::uint8_t> before_mac);

/// First 4 bytes (little-endian) of BLAKE2b-512 of the canonical effective configuration: Header::config_hash.
/// Python: int.from_bytes(hashlib.blake2b(text).digest()[:4], "little").
std::uint32_t config_hash(std::string_view canonical_configuration);

}  // namespace scree::node::protocol
