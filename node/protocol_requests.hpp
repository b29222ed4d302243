#pragma once
// What clients ask and what the node answers: SUBSCRIBE, COOKIE, NACK, PING, PONG (offset tables: docs/protocol.md).
// encode and decode as in protocol_messages.hpp.

#include <array>
#include <cstdint>

#include "node/protocol_header.hpp"
#include "node/protocol_tile.hpp"
#include "node/tile_window.hpp"

namespace scree::node::protocol {

inline constexpr std::uint8_t kMaxRepeats = 3;
inline constexpr std::size_t kMaxNackTiles = 128;

/// Tiles, both ends included.
struct TileRegion {
  std::int32_t tx_min = -kTileIndexLimit;  ///< the defaults are everything
  std::int32_t ty_min = -kTileIndexLimit;
  std::int32_t tx_max = kTileIndexLimit - 1;
  std::int32_t ty_max = kTileIndexLimit - 1;

  bool contains(TileIndex tile) const {
    return tile.tx >= tx_min && tile.tx <= tx_max && tile.ty >= ty_min && tile.ty <= ty_max;
  }
  friend bool operator==(const TileRegion&, const TileRegion&) = default;
};

struct Subscribe {
  std::uint64_t cookie = 0;      ///< 0 = none yet
  std::uint64_t layer_mask = 0;  ///< bit i = layer i; 0 = end the subscription
  TileRegion region;
  std::uint32_t datagrams_per_s = 0;  ///< at most; 0 = the node's own pacing
  std::uint8_t repeats = 0;           ///< extra copies of each changed block, at most kMaxRepeats
  friend bool operator==(const Subscribe&, const Subscribe&) = default;
};

struct Cookie {
  std::uint64_t cookie = 0;  ///< never 0 on the wire
  std::uint32_t lease_ms = 0;
  friend bool operator==(const Cookie&, const Cookie&) = default;
};

struct Nack {
  std::uint64_t cookie = 0;
  Layer layer = Layer::cost;
  std::uint8_t count = 0;                        ///< 1 … 128
  std::array<TileIndex, kMaxNackTiles> tiles{};  ///< the first `count`
};

struct Ping {
  std::uint64_t nonce = 0;
  std::int64_t t_request_ns = 0;  ///< Unix time of the asker's clock at sending
  friend bool operator==(const Ping&, const Ping&) = default;
};

struct Pong {
  std::uint64_t nonce = 0;        ///< of the PING
  std::int64_t t_request_ns = 0;  ///< of the PING
  std::int64_t t_receive_ns = 0;  ///< Unix time of the answerer's clock when it arrived
  std::int64_t t_answer_ns = 0;   ///< and when the answer left
  friend bool operator==(const Pong&, const Pong&) = default;
};

void encode(Header header, const Subscribe& message, Datagram& out, const Key* key = nullptr);
void encode(Header header, const Cookie& message, Datagram& out, const Key* key = nullptr);
void encode(Header header, const Nack& message, Datagram& out, const Key* key = nullptr);
void encode(Header header, const Ping& message, Datagram& out, const Key* key = nullptr);
void encode(Header header, const Pong& message, Datagram& out, const Key* key = nullptr);

Reject decode(const Opened& opened, Subscribe& out);
Reject decode(const Opened& opened, Cookie& out);
Reject decode(const Opened& opened, Nack& out);
Reject decode(const Opened& opened, Ping& out);
Reject decode(const Opened& opened, Pong& out);

inline constexpr std::size_t kSubscribeBytes = 40;
inline constexpr std::size_t kCookieBytes = 16;
inline constexpr std::size_t kNackBytes = 16;  ///< then 8 for each tile
inline constexpr std::size_t kNackTileBytes = 8;
inline constexpr std::size_t kPingBytes = 32;  ///< PONG too

}  // namespace scree::node::protocol
