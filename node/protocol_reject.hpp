#pragma once
// Why a datagram was not used. A bad datagram is an everyday event with a counter, not an Error: nothing is allocated
// for it and no message is composed.

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace scree::node::protocol {

/// In the order of the checks.
enum class Reject : std::uint8_t {
  none,           ///< accepted
  too_short,      ///< fewer than 64 bytes, or than the header and the MAC it announces
  too_long,       ///< more than 1200 bytes
  magic,          ///< does not begin with SCRE
  version,        ///< other major version
  total_length,   ///< total_len is not the received length
  header_length,  ///< header_len below 64 or beyond the datagram
  crc,
  mac,          ///< with keys: no MAC, another key_id, or a wrong one; without keys: a MAC that nothing can check
  stream,       ///< another stream_id
  origin,       ///< an origin that the receiver does not accept
  old_boot,     ///< of a boot_id that a later one has replaced
  sequence,     ///< a duplicate, or older than the reorder window
  type,         ///< unknown message type, or one that is not for this receiver
  layer,        ///< unknown layer
  body_length,  ///< the body does not have the length its type demands
  body_value,   ///< a field out of bounds, or fields that contradict each other
};
inline constexpr std::size_t kRejectReasons = 17;

/// Snake-case name as in logs and JSON.
constexpr std::string_view reject_name(Reject reason) {
  constexpr std::string_view kNames[kRejectReasons] = {
      "none",   "too_short", "too_long", "magic",    "version", "total_length", "header_length", "crc",       "mac",
      "stream", "origin",    "old_boot", "sequence", "type",    "layer",        "body_length",   "body_value"};
  return kNames[static_cast<std::size_t>(reason)];
}

}  // namespace scree::node::protocol
