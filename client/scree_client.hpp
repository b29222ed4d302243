// scree_client.hpp: receives Scree's terrain map over UDP. One header, C++17, Linux sockets, nothing to link.
//
// SPDX-License-Identifier: MIT
// Copyright (c) 2026 The Scree authors
//
// Permission is hereby granted, free of charge, to any person obtaining a copy of this software and associated
// documentation files (the "Software"), to deal in the Software without restriction, including without limitation the
// rights to use, copy, modify, merge, publish, distribute, sublicense, and/or sell copies of the Software, and to
// permit persons to whom the Software is furnished to do so, subject to the following conditions: The above copyright
// notice and this permission notice shall be included in all copies or substantial portions of the Software. THE
// SOFTWARE IS PROVIDED "AS IS", WITHOUT WARRANTY OF ANY KIND, EXPRESS OR IMPLIED, INCLUDING BUT NOT LIMITED TO THE
// WARRANTIES OF MERCHANTABILITY, FITNESS FOR A PARTICULAR PURPOSE AND NONINFRINGEMENT. IN NO EVENT SHALL THE AUTHORS OR
// COPYRIGHT HOLDERS BE LIABLE FOR ANY CLAIM, DAMAGES OR OTHER LIABILITY, WHETHER IN AN ACTION OF CONTRACT, TORT OR
// OTHERWISE, ARISING FROM, OUT OF OR IN CONNECTION WITH THE SOFTWARE OR THE USE OR OTHER DEALINGS IN THE SOFTWARE.
//
// Example:
//
//   #include "scree_client.hpp"
//   #include <cstdio>
//   int main() {
//     scree::client::Config config;              // hears 127.0.0.1:47800, stream 1, LIVE maps only
//     scree::client::Client map;
//     if (!map.open(config)) return std::fprintf(stderr, "%s\n", map.error()), 1;
//     for (;;) {
//       map.wait(std::chrono::milliseconds(20));  // until something arrives
//       map.poll();                               // takes what is there; never blocks
//       if (!map.fresh() || map.health() != 0) continue;  // stop the robot here; health(): sensor or pose lost, FAULT
//       std::printf("%d\n", map.cost(1.0, 2.0));  // 0 free ... 254 lethal, 255 unknown (never drive)
//     }
//   }
//
// What it promises (docs/protocol.md has every rule, docs/client.md the story): whatever is not known to be current
// reads as unknown. Every reading function judges freshness at the time it is called, so a program that stops calling
// poll() reads unknown too. Nothing is allocated after open(), nothing throws, no thread is made. A datagram that is
// not used is counted under one reason. One object is for one thread at a time.

#ifndef SCREE_CLIENT_HPP
#define SCREE_CLIENT_HPP

#include <algorithm>
#include <arpa/inet.h>
#include <array>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <memory>
#include <netinet/in.h>
#include <new>
#include <poll.h>
#include <sys/random.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

namespace scree {
namespace client {

using Clock = std::chrono::steady_clock;
using Time = Clock::time_point;
using Duration = std::chrono::nanoseconds;

enum class Layer : std::uint8_t {
  cost = 0,
  elevation = 1,        ///< m
  dimension = 2,        ///< fractal dimension D, 2 ... 3
  elevation_sigma = 3,  ///< m
  cell_age = 4,         ///< s since the cell's newest return
  hits = 5,
  slope = 6,      ///< rad
  step = 7,       ///< m
  amplitude = 8,  ///< m, rms height change between points 1 m apart
  dimension_sigma = 9,
  cell_state = 10,  ///< see CellState
};
constexpr std::size_t kLayers = 11;
constexpr std::uint32_t layer_bit(Layer layer) {
  return std::uint32_t{1} << static_cast<unsigned>(layer);
}

enum class CellState : std::uint8_t {
  never_seen = 0,
  occluded = 1,
  possible_drop = 2,
  reconstructed = 3,
  measured = 4
};
enum class Origin : std::uint8_t { live = 0, replay = 1, sim = 2, hil = 3 };
constexpr std::uint8_t origin_bit(Origin origin) {
  return static_cast<std::uint8_t>(1U << static_cast<unsigned>(origin));
}

/// waiting: nothing heard yet. fresh: drive. stale: no heartbeat for 300 ms; values stay. lost: every cell is unknown.
enum class State : std::uint8_t { waiting, fresh, stale, lost };

/// Bits of health(); kFault (do not drive) makes the map lost. Two senders on one stream raise it here.
enum Health : std::uint16_t {
  kSensorStale = 1 << 0,
  kSensorLost = 1 << 1,
  kPoseStale = 1 << 2,
  kOverload = 1 << 3,
  kCalibrationMissing = 1 << 4,
  kClockStepped = 1 << 5,
  kReducedResolution = 1 << 6,
  kRecordingFailed = 1 << 7,
  kFault = 1 << 15,
};

/// Costs that are not a measure: lethal, and not known.
constexpr int kCostLethal = 254;
constexpr int kCostUnknown = 255;

/// What became of a datagram, in the order of the checks.
enum class Verdict : std::uint8_t {
  accepted,
  too_short,
  too_long,
  magic,
  version,
  total_length,
  header_length,
  crc,
  mac,       ///< with keys: no MAC, another key_id or a wrong MAC; without: a MAC that nothing can check
  stream,    ///< another stream_id
  origin,    ///< replay, sim or hil where Config does not accept it
  old_boot,  ///< of a sender that another one has replaced
  sequence,  ///< duplicate, or 1024 or more behind the newest
  type,      ///< unknown, or not for a receiver
  layer,     ///< unknown layer
  body_length,
  body_value,
};
constexpr std::size_t kVerdicts = 17;
inline const char* name(Verdict verdict) {
  static const char* const kNames[kVerdicts] = {
      "accepted", "too_short", "too_long", "magic",    "version", "total_length", "header_length", "crc",       "mac",
      "stream",   "origin",    "old_boot", "sequence", "type",    "layer",        "body_length",   "body_value"};
  return kNames[static_cast<std::size_t>(verdict)];
}

/// A shared secret; id is 1 ... 65535 and must agree on both sides.
struct Key {
  std::uint16_t id = 0;
  std::array<std::uint8_t, 32> bytes{};
};

struct Config {
  const char* bind = "127.0.0.1:47800";  ///< one numeric address of this machine; port 0 = any free one
  const char* multicast = nullptr;       ///< IPv4 group to join on the interface of `bind`, at its port
  const char* node = nullptr;            ///< "127.0.0.1:47801": subscribe there, ask for lost tiles, ping
  std::int64_t stream_id = 1;            ///< kAnyStream: the first one heard
  static constexpr std::int64_t kAnyStream = -1;
  std::uint8_t accept_origins = origin_bit(Origin::live);  ///< sum of origin_bit; others are dropped and counted
  /// Layers to hold (and to ask for). Memory and traffic grow with each.
  std::uint32_t layers = layer_bit(Layer::cost) | layer_bit(Layer::elevation) | layer_bit(Layer::dimension) |
                         layer_bit(Layer::cell_age) | layer_bit(Layer::amplitude) | layer_bit(Layer::cell_state);
  std::uint32_t max_window_tiles = 1024;  ///< of 32 x 32 cells; a larger window is refused and counted
  Duration cell_max_age{0};               ///< older blocks read as unknown; 0 = as the node announces
  Key keys[2];                            ///< id 0 = none; the first one signs requests
  // of the subscription
  std::int32_t tx_min = -(1 << 26), ty_min = -(1 << 26), tx_max = (1 << 26) - 1, ty_max = (1 << 26) - 1;  ///< tiles
  std::uint32_t datagrams_per_s = 0;                    ///< at most; 0 = as the node paces
  std::uint8_t repeats = 1;                             ///< extra copies of each changed block, 0 ... 3
  void (*log)(void* user, const char* text) = nullptr;  ///< told once of each thing that needs a human
  void* log_user = nullptr;
};

/// accepted + the sum of the other verdicts == datagrams.
struct Counters {
  std::uint64_t datagrams = 0;
  std::array<std::uint64_t, kVerdicts> by_verdict{};
  std::uint64_t lost = 0;                      ///< gaps in seq that no late datagram filled
  std::uint64_t overflowed = 0;                ///< dropped by the kernel: receive buffer full, poll() called too rarely
  std::uint64_t boots = 0;                     ///< senders heard, one after the other
  std::uint64_t tiles = 0;                     ///< blocks taken into the map
  std::uint64_t tiles_without_window = 0;      ///< accepted, but no ANNOUNCE yet, or its window was refused
  std::uint64_t tiles_outside = 0;             ///< accepted, but outside the window
  std::uint64_t tiles_outdated = 0;            ///< accepted, but older than what is held
  std::uint64_t tiles_not_held = 0;            ///< accepted, of a layer that Config leaves out
  std::uint64_t manifests_without_window = 0;  ///< as tiles_without_window
  std::uint64_t windows_refused = 0;           ///< announced windows beyond max_window_tiles
  std::uint64_t pongs_unasked = 0;             ///< with a nonce that is not the last PING's
  std::uint64_t subscribes_sent = 0;
  std::uint64_t nacks_sent = 0;
  std::uint64_t tiles_nacked = 0;
  std::uint64_t pings_sent = 0;
  std::uint64_t send_errors = 0;
  std::uint64_t receive_errors = 0;
  std::uint64_t operator[](Verdict verdict) const { return by_verdict[static_cast<std::size_t>(verdict)]; }
  /// Calls visit(name, value) for every counter, in one fixed order.
  template <class Visit>
  void for_each(Visit visit) const;
};

/// The cells that the node speaks of. Cell (column, row) covers x in [x_min_m + column * resolution_m, + resolution_m).
struct Grid {
  double resolution_m = 0.0;
  double x_min_m = 0.0;  ///< lower left corner of cell (0, 0): the origin of an OccupancyGrid
  double y_min_m = 0.0;
  std::int32_t x_min_cells = 0;  ///< the same corner on the map's lattice
  std::int32_t y_min_cells = 0;
  std::uint32_t columns = 0;  ///< 0 while no window is known
  std::uint32_t rows = 0;
  std::size_t cells() const { return std::size_t{columns} * rows; }
};

struct Announce {
  std::uint64_t map_id = 0;
  double resolution_m = 0.0;
  double latitude_deg = 0.0, longitude_deg = 0.0, altitude_m = 0.0, heading_rad = 0.0;  ///< all NaN: not known
  std::int32_t tx_min = 0, ty_min = 0, tx_max = 0, ty_max = 0;
  std::int32_t x_min_cells = 0, y_min_cells = 0;
  std::uint32_t columns = 0, rows = 0;
  std::uint32_t stale_ms = 0, lost_ms = 0, cell_max_age_ms = 0, refresh_ms = 0, heartbeat_ms = 0;
  char frame_name[32] = "";
  char node_name[32] = "";
  char software_version[32] = "";
  std::uint8_t layers = 0;
  std::uint8_t layer[64] = {};  ///< the first `layers`; numbers this header does not know are among them
};

struct Sensor {
  std::uint8_t sensor = 0;
  std::uint8_t state = 0;  ///< 0 no frame yet, 1 ok, 2 stale, 3 lost
  std::uint32_t age_ms = 0;
};

struct Heartbeat {
  std::uint64_t uptime_ms = 0, frames_in = 0, frames_dropped = 0, rss_bytes = 0;
  std::uint32_t latency_p50_us = 0, latency_p99_us = 0, latency_max_us = 0, tiles_known = 0;
  std::uint8_t sensors = 0;
  Sensor sensor[16];
};

struct Pose {
  std::int64_t t_ns = 0;                                                           ///< Unix time at which it held
  double x_m = 0.0, y_m = 0.0, z_m = 0.0, qx = 0.0, qy = 0.0, qz = 0.0, qw = 1.0;  ///< T_map_body
  float variances[6] = {};  ///< m2 of x, y, z; rad2 of roll, pitch, yaw; 0 = not stated
  Duration age{0};          ///< when it was read (pose() adds the time since receipt)
};

/// Of the node's clock against this one, from the last PONG.
struct ClockOffset {
  bool known = false;
  std::int64_t offset_ns = 0;  ///< node's Unix time minus this machine's; wrong by at most round_trip_ns / 2
  std::int64_t round_trip_ns = 0;
};

namespace detail {

constexpr std::size_t kHeaderBytes = 64;
constexpr std::size_t kMacBytes = 16;
constexpr std::size_t kMaxDatagramBytes = 1200;
constexpr std::int32_t kTileLog2 = 5;
constexpr std::int32_t kTileCells = 32;
constexpr std::size_t kTileArea = 1024;
constexpr std::int64_t kTileIndexLimit = std::int64_t{1} << 26;
constexpr std::uint32_t kMaxWindowTiles = 65 * 65;

constexpr Duration kStale = std::chrono::milliseconds(300);
constexpr Duration kLost = std::chrono::milliseconds(1000);
constexpr Duration kBootReorder = std::chrono::seconds(1);
constexpr Duration kOutdated = std::chrono::milliseconds(500);
constexpr Duration kNackAfter = std::chrono::milliseconds(50);
constexpr Duration kNackAgain = std::chrono::milliseconds(100);
constexpr Duration kSubscribeEvery = std::chrono::milliseconds(250);  // twelve in a lease of 3 s: losses do not end it
constexpr Duration kPingEvery = std::chrono::seconds(1);
constexpr Duration kCookieAnswer = std::chrono::milliseconds(100);  // bounds what forged cookies can make us send

enum Type : std::uint8_t {
  kAnnounce = 1,
  kTile = 2,
  kManifest = 3,
  kHeartbeat = 4,
  kPose = 5,
  kSubscribe = 6,
  kCookie = 7,
  kNack = 8,
  kPing = 9,
  kPong = 10,
  kBye = 11,
};

inline std::uint16_t u16(const std::uint8_t* p) {
  return static_cast<std::uint16_t>(p[0] | p[1] << 8);
}
inline std::uint32_t u32(const std::uint8_t* p) {
  return u16(p) | std::uint32_t{u16(p + 2)} << 16;
}
inline std::uint64_t u64(const std::uint8_t* p) {
  return u32(p) | std::uint64_t{u32(p + 4)} << 32;
}
inline std::int32_t i32(const std::uint8_t* p) {
  return static_cast<std::int32_t>(u32(p));
}
inline std::int64_t i64(const std::uint8_t* p) {
  return static_cast<std::int64_t>(u64(p));
}
inline float f32(const std::uint8_t* p) {
  const std::uint32_t bits = u32(p);
  float out;
  std::memcpy(&out, &bits, sizeof out);
  return out;
}
inline double f64(const std::uint8_t* p) {
  const std::uint64_t bits = u64(p);
  double out;
  std::memcpy(&out, &bits, sizeof out);
  return out;
}
inline void put(std::uint8_t* p, std::uint64_t value, std::size_t bytes) {
  for (std::size_t i = 0; i < bytes; ++i) p[i] = static_cast<std::uint8_t>(value >> (8 * i));
}

// --- CRC-32 as zlib's (reflected 0x04C11DB7), eight bytes at a time ---

struct CrcTables {
  std::uint32_t t[8][256];
  constexpr CrcTables() : t{} {
    for (std::uint32_t i = 0; i < 256; ++i) {
      std::uint32_t c = i;
      for (int bit = 0; bit < 8; ++bit) c = (c & 1) ? 0xEDB88320U ^ (c >> 1) : c >> 1;
      t[0][i] = c;
    }
    for (std::uint32_t i = 0; i < 256; ++i)
      for (std::size_t k = 1; k < 8; ++k) t[k][i] = t[0][t[k - 1][i] & 0xFF] ^ (t[k - 1][i] >> 8);
  }
};

/// Goes on from `crc`; begin with 0.
inline std::uint32_t crc32(std::uint32_t crc, const std::uint8_t* data, std::size_t size) {
  static constexpr CrcTables kTables{};
  const auto& t = kTables.t;
  crc = ~crc;
  for (; size >= 8; data += 8, size -= 8) {
    const std::uint32_t a = crc ^ u32(data), b = u32(data + 4);
    crc = t[7][a & 0xFF] ^ t[6][(a >> 8) & 0xFF] ^ t[5][(a >> 16) & 0xFF] ^ t[4][a >> 24] ^ t[3][b & 0xFF] ^
          t[2][(b >> 8) & 0xFF] ^ t[1][(b >> 16) & 0xFF] ^ t[0][b >> 24];
  }
  for (; size > 0; ++data, --size) crc = t[0][(crc ^ *data) & 0xFF] ^ (crc >> 8);
  return ~crc;
}

/// Of everything before the MAC, the CRC's own four bytes taken as zero; at least 64 bytes.
inline std::uint32_t datagram_crc(const std::uint8_t* data, std::size_t size) {
  static constexpr std::uint8_t kZero[4] = {};
  std::uint32_t crc = crc32(0, data, 60);
  crc = crc32(crc, kZero, 4);
  return crc32(crc, data + kHeaderBytes, size - kHeaderBytes);
}

// --- BLAKE2b (RFC 7693) ---

inline std::uint64_t rotate_right(std::uint64_t x, unsigned n) {
  return (x >> n) | (x << (64 - n));
}

constexpr std::uint64_t kBlakeIv[8] = {0x6A09E667F3BCC908, 0xBB67AE8584CAA73B, 0x3C6EF372FE94F82B, 0xA54FF53A5F1D36F1,
                                       0x510E527FADE682D1, 0x9B05688C2B3E6C1F, 0x1F83D9ABFB41BD6B, 0x5BE0CD19137E2179};

/// RFC 7693 section 3.2, function F: mixes one block of 128 bytes into the state h.
inline void blake2b_block(std::uint64_t (&h)[8], const std::uint8_t* block, std::uint64_t bytes_so_far, bool last) {
  static constexpr std::uint8_t kSigma[10][16] = {
      {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15}, {14, 10, 4, 8, 9, 15, 13, 6, 1, 12, 0, 2, 11, 7, 5, 3},
      {11, 8, 12, 0, 5, 2, 15, 13, 10, 14, 3, 6, 7, 1, 9, 4}, {7, 9, 3, 1, 13, 12, 11, 14, 2, 6, 5, 10, 4, 0, 15, 8},
      {9, 0, 5, 7, 2, 4, 10, 15, 14, 1, 11, 12, 6, 8, 3, 13}, {2, 12, 6, 10, 0, 11, 8, 3, 4, 13, 7, 5, 15, 14, 1, 9},
      {12, 5, 1, 15, 14, 13, 4, 10, 0, 7, 6, 3, 9, 2, 8, 11}, {13, 11, 7, 14, 12, 1, 3, 9, 5, 0, 15, 4, 8, 6, 2, 10},
      {6, 15, 14, 9, 11, 3, 0, 8, 12, 2, 13, 7, 1, 4, 10, 5}, {10, 2, 8, 4, 7, 6, 1, 5, 15, 11, 9, 14, 3, 12, 13, 0}};
  static constexpr std::uint8_t kLanes[8][4] = {{0, 4, 8, 12},  {1, 5, 9, 13},  {2, 6, 10, 14}, {3, 7, 11, 15},
                                                {0, 5, 10, 15}, {1, 6, 11, 12}, {2, 7, 8, 13},  {3, 4, 9, 14}};
  std::uint64_t m[16], v[16];
  for (std::size_t i = 0; i < 16; ++i) m[i] = u64(block + 8 * i);
  for (std::size_t i = 0; i < 8; ++i) {
    v[i] = h[i];
    v[i + 8] = kBlakeIv[i];
  }
  v[12] ^= bytes_so_far;  // the upper 64 bits of the count are never needed here
  if (last) v[14] = ~v[14];
  for (std::size_t round = 0; round < 12; ++round) {
    const std::uint8_t* const s = kSigma[round % 10];
    for (std::size_t g = 0; g < 8; ++g) {
      std::uint64_t &a = v[kLanes[g][0]], &b = v[kLanes[g][1]], &c = v[kLanes[g][2]], &d = v[kLanes[g][3]];
      a += b + m[s[2 * g]];
      d = rotate_right(d ^ a, 32);
      c += d;
      b = rotate_right(b ^ c, 24);
      a += b + m[s[2 * g + 1]];
      d = rotate_right(d ^ a, 16);
      c += d;
      b = rotate_right(b ^ c, 63);
    }
  }
  for (std::size_t i = 0; i < 8; ++i) h[i] ^= v[i] ^ v[i + 8];
}

/// `out_bytes` 1 ... 64 of output, `key_bytes` 0 ... 64.
inline void blake2b(std::uint8_t* out, std::size_t out_bytes, const std::uint8_t* key, std::size_t key_bytes,
                    const std::uint8_t* data, std::size_t size) {
  std::uint64_t h[8];
  for (std::size_t i = 0; i < 8; ++i) h[i] = kBlakeIv[i];
  h[0] ^= 0x01010000U ^ (key_bytes << 8) ^ out_bytes;
  std::uint64_t done = 0;
  std::uint8_t block[128] = {};
  if (key_bytes > 0) {
    std::memcpy(block, key, key_bytes);
    done = 128;
    blake2b_block(h, block, done, size == 0);
  }
  for (; size > 128; data += 128, size -= 128) {
    done += 128;
    blake2b_block(h, data, done, false);
  }
  if (size > 0 || key_bytes == 0) {
    std::memset(block, 0, sizeof block);
    if (size > 0) std::memcpy(block, data, size);
    blake2b_block(h, block, done + size, true);
  }
  for (std::size_t i = 0; i < out_bytes; ++i) out[i] = static_cast<std::uint8_t>(h[i / 8] >> (8 * (i % 8)));
}

/// The MAC trailer of a datagram: BLAKE2b-128 over everything before it, keyed.
inline void datagram_mac(const Key& key, const std::uint8_t* data, std::size_t size, std::uint8_t (&out)[kMacBytes]) {
  blake2b(out, kMacBytes, key.bytes.data(), key.bytes.size(), data, size);
}

/// In a time that does not depend on where they differ.
inline bool same_mac(const std::uint8_t* a, const std::uint8_t* b) {
  unsigned difference = 0;
  for (std::size_t i = 0; i < kMacBytes; ++i) difference |= static_cast<unsigned>(a[i] ^ b[i]);
  return difference == 0;
}

// --- which datagrams of a sender were seen ---

class SequenceWindow {
 public:
  static constexpr std::uint64_t kWindow = 1024;

  /// False: a duplicate, or too old to tell.
  bool note(std::uint64_t seq) {
    if (received_ == 0) {
      first_ = highest_ = seq;
    } else if (seq > highest_) {
      const std::uint64_t step = seq - highest_;
      if (step >= kWindow)
        clear_all();
      else
        for (std::uint64_t i = 1; i < step; ++i) set(highest_ + i, false);
      highest_ = seq;
    } else {
      if (highest_ - seq >= kWindow || test(seq)) return false;
      first_ = std::min(first_, seq);
    }
    set(seq, true);
    ++received_;
    return true;
  }
  std::uint64_t lost() const { return received_ == 0 ? 0 : highest_ - first_ + 1 - received_; }
  void reset() { *this = SequenceWindow(); }

 private:
  void clear_all() { std::memset(seen_, 0, sizeof seen_); }
  bool test(std::uint64_t seq) const { return (seen_[seq % kWindow / 64] >> (seq % 64)) & 1; }
  void set(std::uint64_t seq, bool value) {
    std::uint64_t& word = seen_[seq % kWindow / 64];
    word = (word & ~(std::uint64_t{1} << (seq % 64))) | std::uint64_t{value} << (seq % 64);
  }

  std::uint64_t seen_[kWindow / 64] = {};
  std::uint64_t first_ = 0, highest_ = 0, received_ = 0;
};

/// The header's fields that are used after the checks; `body` points into the datagram.
struct Opened {
  std::uint8_t minor = 0, type = 0;
  Origin origin = Origin::live;
  std::uint32_t stream_id = 0, age_us = 0, map_rev = 0, config_hash = 0;
  std::uint64_t boot_id = 0, seq = 0;
  std::int64_t t_data_ns = 0;
  std::uint16_t health = 0, cost_profile = 0;
  const std::uint8_t* body = nullptr;
  std::size_t body_bytes = 0;

  /// A body of 1.0 ends where its type says; what a later minor version appends is skipped.
  bool body_fits(std::size_t expected) const { return minor == 0 ? body_bytes == expected : body_bytes >= expected; }
};

inline bool is_i16(Layer layer) {
  return layer == Layer::elevation;
}
inline std::size_t layer_bytes(Layer layer) {
  return is_i16(layer) ? 2 * kTileArea : kTileArea;
}

/// A block whose every field has been checked; `cells` are raw wire values, 1024 bytes.
struct TileBlock {
  std::int32_t tx = 0, ty = 0;
  std::uint32_t rev = 0, age_ms = 0;
  Layer layer = Layer::cost;
  std::uint8_t half = 0;  ///< 1: the upper half of a 16-bit layer
  float scale = 1.0F, offset = 0.0F;
  const std::uint8_t* cells = nullptr;
};

inline std::size_t known_cells(const std::uint8_t* cells, bool i16) {
  std::size_t unknown = 0;
  if (i16)
    for (std::size_t i = 0; i < kTileArea; i += 2) unknown += cells[i] == 0x00 && cells[i + 1] == 0x80;
  else
    for (std::size_t i = 0; i < kTileArea; ++i) unknown += cells[i] == 0xFF;
  return (i16 ? kTileArea / 2 : kTileArea) - unknown;
}

/// Pairs (count, value) that give exactly 1024 cells; `used` is how many bytes they took. Nothing may follow if
/// `exact`.
inline Verdict expand_runs(const std::uint8_t* data, std::size_t size, bool exact, std::uint8_t* cells,
                           std::size_t& used) {
  std::size_t filled = 0;
  used = 0;
  while ((exact || filled < kTileArea) && size - used >= 2) {
    const std::size_t run = data[used];
#ifdef SCREE_CLIENT_BUG_FOR_THE_FUZZER_TO_FIND
    if (run == 0) return Verdict::body_value;
#else
    if (run == 0 || run > kTileArea - filled) return Verdict::body_value;
#endif
    std::memset(cells + filled, data[used + 1], run);
    filled += run;
    used += 2;
  }
  return filled == kTileArea ? Verdict::accepted : Verdict::body_length;
}

/// `scratch` has room for 1024 bytes. A block takes 1024 bytes of cells in either kind of layer: 32 rows of 8 bits or
/// 16 rows of 16.
inline Verdict decode_tile(const Opened& opened, TileBlock& out, std::uint8_t* scratch) {
  constexpr std::size_t kFixed = 32;
  const std::uint8_t* const p = opened.body;
  if (opened.body_bytes <= kFixed) return Verdict::body_length;
  if (p[12] >= kLayers) return Verdict::layer;
  out.layer = static_cast<Layer>(p[12]);
  const bool i16 = is_i16(out.layer);
  out.tx = i32(p);
  out.ty = i32(p + 4);
  out.rev = u32(p + 8);
  out.half = p[15] == 16 ? 1 : 0;
  out.scale = f32(p + 20);
  out.offset = f32(p + 24);
  out.age_ms = u32(p + 28);
  const auto index_ok = [](std::int32_t i) { return i >= -kTileIndexLimit && i < kTileIndexLimit; };
  const bool rows_ok = i16 ? p[16] == 16 && (p[15] == 0 || p[15] == 16) : p[15] == 0 && p[16] == 32;
  if (p[14] != kTileLog2 || !rows_ok || !index_ok(out.tx) || !index_ok(out.ty)) return Verdict::body_value;
  if (!std::isfinite(out.scale) || !(out.scale > 0.0F) || !std::isfinite(out.offset)) return Verdict::body_value;

  const std::uint8_t* const data = p + kFixed;
  const std::size_t size = opened.body_bytes - kFixed;
  const unsigned encoding = p[13];
  std::size_t used = kTileArea;
  out.cells = scratch;
  if (encoding == 3) {  // constant
    used = i16 ? 2 : 1;
    if (size < used) return Verdict::body_length;
    for (std::size_t i = 0; i < kTileArea; ++i) scratch[i] = data[i % used];
  } else if (encoding == 4 && !i16) {  // run-length
    const Verdict verdict = expand_runs(data, size, opened.minor == 0, scratch, used);
    if (verdict != Verdict::accepted) return verdict;
  } else if (encoding == (i16 ? 1U : 0U)) {
    out.cells = data;
    if (size < used) return Verdict::body_length;
  } else {
    return Verdict::body_value;
  }
  if (!opened.body_fits(kFixed + used)) return Verdict::body_length;
  return known_cells(out.cells, i16) == u16(p + 18) ? Verdict::accepted : Verdict::body_value;
}

/// UTF-8 without control characters, 1 ... 31 bytes and a NUL.
inline bool read_name(const std::uint8_t* p, char (&out)[32]) {
  std::size_t n = 0;
  while (n < 32 && p[n] != 0) {
    if (p[n] < 0x20 || p[n] == 0x7F) return false;
    ++n;
  }
  if (n == 0 || n == 32) return false;
  std::memset(out, 0, sizeof out);
  std::memcpy(out, p, n);
  return true;
}

/// Not empty, within i32, and the window of tiles is the one that follows from the cells.
inline bool window_ok(const Announce& a) {
  constexpr std::uint32_t kMaxSide = kMaxWindowTiles * 32;
  constexpr std::int64_t kEnd = std::int64_t{1} << 31;
  if (a.columns == 0 || a.rows == 0 || a.columns > kMaxSide || a.rows > kMaxSide) return false;
  const std::int64_t x_end = a.x_min_cells + std::int64_t{a.columns}, y_end = a.y_min_cells + std::int64_t{a.rows};
  if (x_end > kEnd || y_end > kEnd) return false;
  const auto tile_of = [](std::int64_t cell) { return cell >> kTileLog2; };  // floor
  if (a.tx_min != tile_of(a.x_min_cells) || a.ty_min != tile_of(a.y_min_cells)) return false;
  if (a.tx_max != tile_of(x_end - 1) || a.ty_max != tile_of(y_end - 1)) return false;
  const std::int64_t columns = std::int64_t{a.tx_max} - a.tx_min + 1, rows = std::int64_t{a.ty_max} - a.ty_min + 1;
  return columns * rows <= kMaxWindowTiles;
}

inline bool anchor_ok(const Announce& a) {
  const bool none = std::isnan(a.latitude_deg) && std::isnan(a.longitude_deg) && std::isnan(a.altitude_m) &&
                    std::isnan(a.heading_rad);
  return none || (std::abs(a.latitude_deg) <= 90.0 && std::abs(a.longitude_deg) <= 180.0 &&
                  std::isfinite(a.altitude_m) && std::isfinite(a.heading_rad));
}

inline bool layers_ok(const std::uint8_t* p, Announce& out) {
  bool seen[256] = {};
  for (std::size_t i = 0; i < out.layers; ++i, p += 12) {
    const float scale = f32(p + 4), offset = f32(p + 8);
    if (seen[p[0]] || !std::isfinite(scale) || !(scale > 0.0F) || !std::isfinite(offset)) return false;
    seen[p[0]] = true;
    out.layer[i] = p[0];
  }
  return true;
}

inline Verdict decode_announce(const Opened& opened, Announce& out) {
  constexpr std::size_t kFixed = 200;
  const std::uint8_t* const p = opened.body;
  if (opened.body_bytes < kFixed) return Verdict::body_length;
  out.map_id = u64(p);
  out.resolution_m = f64(p + 8);
  out.latitude_deg = f64(p + 16);
  out.longitude_deg = f64(p + 24);
  out.altitude_m = f64(p + 32);
  out.heading_rad = f64(p + 40);
  out.tx_min = i32(p + 48);
  out.ty_min = i32(p + 52);
  out.tx_max = i32(p + 56);
  out.ty_max = i32(p + 60);
  out.x_min_cells = i32(p + 64);
  out.y_min_cells = i32(p + 68);
  out.columns = u32(p + 72);
  out.rows = u32(p + 76);
  out.stale_ms = u32(p + 80);
  out.lost_ms = u32(p + 84);
  out.cell_max_age_ms = u32(p + 88);
  out.refresh_ms = u32(p + 92);
  out.heartbeat_ms = u32(p + 96);
  out.layers = p[101];
  if (!std::isfinite(out.resolution_m) || !(out.resolution_m > 0.0)) return Verdict::body_value;
  if (!anchor_ok(out) || !window_ok(out)) return Verdict::body_value;
  if (out.stale_ms == 0 || out.lost_ms < out.stale_ms || out.refresh_ms == 0 || out.heartbeat_ms == 0)
    return Verdict::body_value;
  if (p[100] != kTileLog2 || out.layers > 64) return Verdict::body_value;
  if (!opened.body_fits(kFixed + std::size_t{12} * out.layers)) return Verdict::body_length;
  const bool names = read_name(p + 104, out.frame_name) && read_name(p + 136, out.node_name) &&
                     read_name(p + 168, out.software_version);
  return names && layers_ok(p + kFixed, out) ? Verdict::accepted : Verdict::body_value;
}

struct Manifest {
  std::int32_t tx0 = 0, ty0 = 0;
  std::int32_t columns = 0, rows = 0;
  Layer layer = Layer::cost;
  const std::uint8_t* revisions = nullptr;  ///< columns * rows u32
};

inline Verdict decode_manifest(const Opened& opened, Manifest& out) {
  constexpr std::size_t kFixed = 16;
  const std::uint8_t* const p = opened.body;
  if (opened.body_bytes < kFixed) return Verdict::body_length;
  out.tx0 = i32(p);
  out.ty0 = i32(p + 4);
  out.columns = u16(p + 8);
  out.rows = u16(p + 10);
  const auto fits = [](std::int64_t first, std::int64_t count) {
    return first >= -kTileIndexLimit && first + count <= kTileIndexLimit;
  };
  const std::int64_t tiles = std::int64_t{out.columns} * out.rows;
  if (tiles < 1 || tiles > 256 || !fits(out.tx0, out.columns) || !fits(out.ty0, out.rows) || p[13] != kTileLog2)
    return Verdict::body_value;
  if (p[12] >= kLayers) return Verdict::layer;
  out.layer = static_cast<Layer>(p[12]);
  out.revisions = p + kFixed;
  return opened.body_fits(kFixed + 4 * static_cast<std::size_t>(tiles)) ? Verdict::accepted : Verdict::body_length;
}

inline Verdict decode_heartbeat(const Opened& opened, Heartbeat& out) {
  constexpr std::size_t kFixed = 56;
  const std::uint8_t* const p = opened.body;
  if (opened.body_bytes < kFixed) return Verdict::body_length;
  out.uptime_ms = u64(p);
  out.frames_in = u64(p + 8);
  out.frames_dropped = u64(p + 16);
  out.rss_bytes = u64(p + 24);
  out.latency_p50_us = u32(p + 32);
  out.latency_p99_us = u32(p + 36);
  out.latency_max_us = u32(p + 40);
  out.tiles_known = u32(p + 44);
  out.sensors = p[48];
  if (out.sensors > 16) return Verdict::body_value;
  if (!opened.body_fits(kFixed + std::size_t{8} * out.sensors)) return Verdict::body_length;
  for (std::size_t i = 0; i < out.sensors; ++i) {
    const std::uint8_t* const s = p + kFixed + 8 * i;
    out.sensor[i].sensor = s[0];
    out.sensor[i].state = s[1];
    out.sensor[i].age_ms = u32(s + 4);
    if (s[1] > 3) return Verdict::body_value;
  }
  return Verdict::accepted;
}

inline Verdict decode_pose(const Opened& opened, Pose& out) {
  constexpr std::size_t kFixed = 96;
  constexpr std::int64_t kMaxTime_ns = std::int64_t{4'000'000'000} * 1'000'000'000;
  const std::uint8_t* const p = opened.body;
  if (opened.body_bytes < kFixed || !opened.body_fits(kFixed)) return Verdict::body_length;
  out.t_ns = i64(p);
  out.x_m = f64(p + 8);
  out.y_m = f64(p + 16);
  out.z_m = f64(p + 24);
  out.qx = f64(p + 32);
  out.qy = f64(p + 40);
  out.qz = f64(p + 48);
  out.qw = f64(p + 56);
  out.age = std::chrono::microseconds(u32(p + 88));
  if (out.t_ns > kMaxTime_ns || out.t_ns < -kMaxTime_ns) return Verdict::body_value;
  const auto place_ok = [](double value) { return std::abs(value) <= 1e8; };  // false for NaN
  if (!place_ok(out.x_m) || !place_ok(out.y_m) || !place_ok(out.z_m)) return Verdict::body_value;
  const double norm = std::sqrt(out.qx * out.qx + out.qy * out.qy + out.qz * out.qz + out.qw * out.qw);
  if (!(std::abs(norm - 1.0) <= 1e-3)) return Verdict::body_value;
  for (std::size_t i = 0; i < 6; ++i) {
    out.variances[i] = f32(p + 64 + 4 * i);
    if (!std::isfinite(out.variances[i]) || out.variances[i] < 0.0F) return Verdict::body_value;
  }
  return Verdict::accepted;
}

/// COOKIE, PONG and BYE have bodies of one size, of which any content will do but a cookie of 0.
inline Verdict decode_fixed(const Opened& opened, std::size_t bytes) {
  if (opened.body_bytes < bytes || !opened.body_fits(bytes)) return Verdict::body_length;
  return opened.type == kCookie && u64(opened.body) == 0 ? Verdict::body_value : Verdict::accepted;
}
constexpr std::size_t kCookieBytes = 16, kPongBytes = 32, kByeBytes = 8;

/// Length, magic, version, total_len, header_len, CRC and MAC, in that order.
inline Verdict open_datagram(const std::uint8_t* data, std::size_t size, const Key (&keys)[2], Opened& out) {
  if (size < kHeaderBytes) return Verdict::too_short;
  if (size > kMaxDatagramBytes) return Verdict::too_long;
  if (std::memcmp(data, "SCRE", 4) != 0) return Verdict::magic;
  if (data[4] != 1) return Verdict::version;
  if (u16(data + 10) != size) return Verdict::total_length;
  const bool has_mac = (data[7] & 1) != 0;
  if (has_mac && size < kHeaderBytes + kMacBytes) return Verdict::too_short;
  const std::size_t end = size - (has_mac ? kMacBytes : 0);
  const std::size_t header = u16(data + 8);
  if (header < kHeaderBytes || header > end) return Verdict::header_length;
  if (u32(data + 60) != datagram_crc(data, end)) return Verdict::crc;
  const bool keyed = keys[0].id != 0 || keys[1].id != 0;
  if (has_mac || keyed) {
    const std::uint16_t id = u16(data + 56);
    const Key* key = nullptr;
    for (const Key& candidate : keys)
      if (has_mac && id != 0 && candidate.id == id) key = &candidate;
    if (key == nullptr) return Verdict::mac;
    std::uint8_t mac[kMacBytes];
    datagram_mac(*key, data, end, mac);
    if (!same_mac(mac, data + end)) return Verdict::mac;
  }
  out.minor = data[5];
  out.type = data[6];
  out.origin = static_cast<Origin>((data[7] >> 4) & 3);
  out.stream_id = u32(data + 12);
  out.boot_id = u64(data + 16);
  out.seq = u64(data + 24);
  out.t_data_ns = i64(data + 32);
  out.age_us = u32(data + 40);
  out.map_rev = u32(data + 44);
  out.health = u16(data + 48);
  out.cost_profile = u16(data + 50);
  out.config_hash = u32(data + 52);
  out.body = data + header;
  out.body_bytes = end - header;
  return Verdict::accepted;
}

// --- the tiles ---

struct Block {
  bool held = false;
  std::uint32_t rev = 0;
  std::uint32_t age_ms = 0;  ///< on arrival
  float scale = 1.0F, offset = 0.0F;
  Time arrived;
};

/// One layer of one tile. 16-bit layers have two blocks.
struct LayerTile {
  Block block[2];
  std::uint32_t wanted_rev = 0;  ///< the newest that a manifest named
  bool outdated = false;         ///< a block is older than that, or missing
  Time wanted_since;             ///< when wanted_rev last grew
  Time outdated_since;
  std::uint32_t outdated_rev = 0;  ///< wanted at outdated_since: only a tile that has it begins to wait anew
  Time nack_at;                    ///< not before
};

struct TileWindow {
  std::int32_t tx = 0, ty = 0, columns = 0, rows = 0;
  bool contains(std::int64_t x, std::int64_t y) const {
    return x >= tx && x < tx + std::int64_t{columns} && y >= ty && y < ty + std::int64_t{rows};
  }
  std::size_t tiles() const { return static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows); }
  std::size_t position(std::int64_t x, std::int64_t y) const {
    return static_cast<std::size_t>(y - ty) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(x - tx);
  }
  friend bool operator==(const TileWindow& a, const TileWindow& b) {
    return a.tx == b.tx && a.ty == b.ty && a.columns == b.columns && a.rows == b.rows;
  }
};

/// All memory is taken once: a window that moves only renumbers which place belongs to which tile.
class TileStore {
 public:
  /// False: not enough memory.
  bool allocate(std::uint32_t max_tiles, std::uint32_t layers) {
    max_tiles_ = max_tiles;
    layer_count_ = 0;
    stride_ = 0;
    for (std::size_t i = 0; i < kLayers; ++i) {
      index_[i] = (layers >> i) & 1 ? static_cast<int>(layer_count_++) : -1;
      offset_[i] = stride_;
      if (index_[i] >= 0) stride_ += layer_bytes(static_cast<Layer>(i));
    }
    place_.reset(new (std::nothrow) std::uint32_t[max_tiles]);
    next_place_.reset(new (std::nothrow) std::uint32_t[max_tiles]);
    taken_.reset(new (std::nothrow) bool[max_tiles]);
    tiles_.reset(new (std::nothrow) LayerTile[max_tiles * layer_count_]);
    cells_.reset(new (std::nothrow) std::uint8_t[max_tiles * stride_]);
    scratch_.reset(new (std::nothrow) std::uint8_t[kTileArea]);
    window_ = {};
    if (!place_ || !next_place_ || !taken_ || !tiles_ || !cells_ || !scratch_) return false;
    std::memset(cells_.get(), 0xFF, max_tiles * stride_);  // touches every page now, not while driving
    return true;
  }
  std::size_t bytes() const {
    return max_tiles_ * (stride_ + layer_count_ * sizeof(LayerTile) + 2 * sizeof(std::uint32_t) + sizeof(bool)) +
           kTileArea;
  }
  std::uint32_t max_tiles() const { return max_tiles_; }
  std::uint8_t* scratch() { return scratch_.get(); }
  const TileWindow& window() const { return window_; }
  bool holds(Layer layer) const { return index_[static_cast<std::size_t>(layer)] >= 0; }

  /// Tiles that are in both windows stay; the others are forgotten. At most max_tiles.
  void set_window(const TileWindow& next) {
    if (next == window_) return;
    std::fill_n(taken_.get(), max_tiles_, false);
    constexpr std::uint32_t kNone = 0xFFFFFFFF;
    for (std::size_t i = 0; i < next.tiles(); ++i) {
      const std::int64_t x = next.tx + static_cast<std::int64_t>(i % static_cast<std::size_t>(next.columns));
      const std::int64_t y = next.ty + static_cast<std::int64_t>(i / static_cast<std::size_t>(next.columns));
      next_place_[i] = window_.contains(x, y) ? place_[window_.position(x, y)] : kNone;
      if (next_place_[i] != kNone) taken_[next_place_[i]] = true;
    }
    std::uint32_t free = 0;
    for (std::size_t i = 0; i < next.tiles(); ++i) {
      if (next_place_[i] != kNone) continue;
      while (taken_[free]) ++free;
      taken_[free] = true;
      next_place_[i] = free;
      for (std::size_t l = 0; l < layer_count_; ++l) tiles_[free * layer_count_ + l] = LayerTile{};
    }
    std::swap(place_, next_place_);
    window_ = next;
  }
  void forget_tiles() {
    for (std::size_t i = 0; i < max_tiles_ * layer_count_; ++i) tiles_[i] = LayerTile{};
  }
  void forget_window() {
    forget_tiles();
    window_ = {};
  }

  /// Null outside the window and for layers that are not held.
  LayerTile* find(Layer layer, std::int64_t tx, std::int64_t ty) {
    const int index = index_[static_cast<std::size_t>(layer)];
    if (index < 0 || !window_.contains(tx, ty)) return nullptr;
    return &tiles_[place_[window_.position(tx, ty)] * layer_count_ + static_cast<std::size_t>(index)];
  }
  const LayerTile* find(Layer layer, std::int64_t tx, std::int64_t ty) const {
    return const_cast<TileStore*>(this)->find(layer, tx, ty);
  }
  /// 1024 raw cells of an 8-bit layer, 1024 of 16 bits little-endian. The tile must be in the window.
  std::uint8_t* cells(Layer layer, std::int64_t tx, std::int64_t ty) {
    return &cells_[place_[window_.position(tx, ty)] * stride_ + offset_[static_cast<std::size_t>(layer)]];
  }
  const std::uint8_t* cells(Layer layer, std::int64_t tx, std::int64_t ty) const {
    return const_cast<TileStore*>(this)->cells(layer, tx, ty);
  }

 private:
  std::uint32_t max_tiles_ = 0;
  std::size_t layer_count_ = 0, stride_ = 0;
  std::array<int, kLayers> index_{};
  std::array<std::size_t, kLayers> offset_{};
  TileWindow window_;
  std::unique_ptr<std::uint32_t[]> place_;  // by position in the window
  std::unique_ptr<std::uint32_t[]> next_place_;
  std::unique_ptr<bool[]> taken_;
  std::unique_ptr<LayerTile[]> tiles_;  // by place, then layer
  std::unique_ptr<std::uint8_t[]> cells_;
  std::unique_ptr<std::uint8_t[]> scratch_;
};

/// The oldest revision among a tile's blocks; a missing one counts as 0.
inline std::uint32_t held_rev(const LayerTile& tile, Layer layer) {
  const std::uint32_t lower = tile.block[0].held ? tile.block[0].rev : 0;
  if (!is_i16(layer)) return lower;
  return std::min(lower, tile.block[1].held ? tile.block[1].rev : 0);
}

}  // namespace detail

template <class Visit>
void Counters::for_each(Visit visit) const {
  visit("datagrams", datagrams);
  for (std::size_t i = 0; i < kVerdicts; ++i) visit(name(static_cast<Verdict>(i)), by_verdict[i]);
  visit("lost", lost);
  visit("overflowed", overflowed);
  visit("boots", boots);
  visit("tiles", tiles);
  visit("tiles_without_window", tiles_without_window);
  visit("tiles_outside", tiles_outside);
  visit("tiles_outdated", tiles_outdated);
  visit("tiles_not_held", tiles_not_held);
  visit("manifests_without_window", manifests_without_window);
  visit("windows_refused", windows_refused);
  visit("pongs_unasked", pongs_unasked);
  visit("subscribes_sent", subscribes_sent);
  visit("nacks_sent", nacks_sent);
  visit("tiles_nacked", tiles_nacked);
  visit("pings_sent", pings_sent);
  visit("send_errors", send_errors);
  visit("receive_errors", receive_errors);
}

/// Everything but the socket: datagrams and a clock in; a map, its freshness and requests out. For those who have their
/// own transport, and for tests. `now` must not run backwards.
class Receiver {
 public:
  Receiver() = default;
  Receiver(const Receiver&) = delete;
  Receiver& operator=(const Receiver&) = delete;

  /// Takes all memory. False: error() says why.
  bool open(const Config& config, Time now = Clock::now());
  const char* error() const { return error_; }
  std::size_t memory_bytes() const { return store_.bytes(); }

  /// Takes one datagram that arrived at `now`. One that is not accepted changes nothing but a counter, except that one
  /// of an earlier sender can raise kFault.
  Verdict accept(const std::uint8_t* data, std::size_t size, Time now);
  /// Applies the rules that depend on time alone.
  void advance(Time now);
  /// Writes the next datagram to be sent to the node; returns its size, 0 when there is none now.
  std::size_t next_request(std::uint8_t (&out)[detail::kMaxDatagramBytes], Time now);
  /// Writes the SUBSCRIBE that ends the subscription; 0 without one.
  std::size_t end_request(std::uint8_t (&out)[detail::kMaxDatagramBytes]);
  /// This machine's Unix time minus Time::time_since_epoch(), for PING; Client sets it.
  void set_unix_offset(std::int64_t offset_ns) { unix_offset_ns_ = offset_ns; }

  State state(Time now = Clock::now()) const { return state_at(now); }
  bool fresh(Time now = Clock::now()) const { return state_at(now) == State::fresh; }
  /// Bits of Health as the node last said, kFault also for two senders on the stream.
  std::uint16_t health(Time now = Clock::now()) const {
    return static_cast<std::uint16_t>(newest_.health | (in_conflict(now) ? kFault : 0));
  }

  /// 0 free, 1 ... 252 worse and worse, 253 the planner's own, 254 lethal, 255 unknown, at a place of the map in
  /// metres.
  int cost(double x_m, double y_m, Time now = Clock::now()) const { return cost_of_cell(cell(x_m), cell(y_m), now); }
  /// NaN: unknown. Layer::cost gives 0 ... 254. CELL_AGE includes the time since the node sent it; a tile whose ages
  /// alone grew may be sent a second late, so take it as "at least".
  float value(Layer layer, double x_m, double y_m, Time now = Clock::now()) const {
    return value_of_cell(layer, cell(x_m), cell(y_m), now);
  }
  CellState cell_state(double x_m, double y_m, Time now = Clock::now()) const {
    return cell_state_of_cell(cell(x_m), cell(y_m), now);
  }
  /// The same by cell of the map's lattice (x_cells = floor(x_m / resolution_m)).
  int cost_of_cell(std::int64_t x_cells, std::int64_t y_cells, Time now = Clock::now()) const;
  float value_of_cell(Layer layer, std::int64_t x_cells, std::int64_t y_cells, Time now = Clock::now()) const;
  CellState cell_state_of_cell(std::int64_t x_cells, std::int64_t y_cells, Time now = Clock::now()) const;

  /// The present window; columns 0 while none is known.
  Grid grid() const;
  /// Whole windows, rows of growing y, in a row growing x, grid().cells() values. False, and nothing is written, when
  /// no window is known or `capacity` is too small. When the map is lost all of them are unknown.
  bool copy_cost(std::uint8_t* out, std::size_t capacity, Time now = Clock::now()) const;
  bool copy_layer(Layer layer, float* out, std::size_t capacity, Time now = Clock::now()) const;
  /// As nav_msgs/OccupancyGrid: -1 unknown (255), 0 (0), 1 ... 98 (1 ... 252), 99 (253), 100 (254); resolution and
  /// origin are grid()'s. The mapping is costmap_2d's: 1 + 97 (cost - 1) / 251.
  bool to_occupancy(std::int8_t* out, std::size_t capacity, Time now = Clock::now()) const;
  static std::int8_t occupancy(int cost) {
    return static_cast<std::int8_t>(cost >= 255   ? -1
                                    : cost >= 253 ? cost - 154
                                    : cost < 1    ? 0
                                                  : 1 + 97 * (cost - 1) / 251);
  }

  /// Null before the first one of the present sender.
  const Announce* announce() const { return has_announce_ ? &announce_ : nullptr; }
  const Heartbeat* heartbeat() const { return has_heartbeat_ ? &heartbeat_ : nullptr; }
  /// False before the first one. `age` is since the pose was delivered to the node.
  bool pose(Pose& out, Time now = Clock::now()) const;
  const Counters& counters() const { return counters_; }
  const ClockOffset& clock_offset() const { return clock_; }
  std::uint64_t boot_id() const { return boot_id_; }
  std::uint32_t map_rev() const { return newest_.map_rev; }
  std::int64_t t_data_ns() const { return newest_.t_data_ns; }  ///< Unix time of the newest sample; 0 = no map yet
  std::uint16_t cost_profile() const { return newest_.cost_profile; }
  std::uint32_t config_hash() const { return newest_.config_hash; }
  /// Since the map's newest sample was delivered to the node; the largest Duration before the first map.
  Duration data_age(Time now = Clock::now()) const;
  bool ended() const { return bye_ >= 0; }
  int bye_reason() const { return bye_; }  ///< 0 end of the recording, 1 stopped, 2 an error, 3 restart; -1 no BYE
  Origin origin() const { return origin_; }
  /// The revision held of a layer of a tile; 0 = none or not complete. For tests and displays.
  std::uint32_t tile_rev(Layer layer, std::int32_t tx, std::int32_t ty) const {
    const detail::LayerTile* const tile = store_.find(layer, tx, ty);
    return tile == nullptr ? 0 : detail::held_rev(*tile, layer);
  }

 protected:
  bool fail(const char* what, const char* expected, const char* found) {
    std::snprintf(error_, sizeof error_, "%s: expected %s, found '%s'", what, expected, found);
    return false;
  }
  Counters counters_;
  char error_[256] = "";

 private:
  using Opened = detail::Opened;

  Verdict judge(const std::uint8_t* data, std::size_t size, Time now);
  Verdict check_sender(const Opened& opened, Time now);
  Verdict check_body(const Opened& opened);
  Verdict take(const Opened& opened, Time now);
  Verdict take_announce(const Opened& opened);
  Verdict take_tile(const Opened& opened, Time now);
  Verdict take_manifest(const Opened& opened, Time now);
  Verdict take_heartbeat(const Opened& opened, Time now);
  Verdict take_pose(const Opened& opened, Time now);
  Verdict take_cookie(const Opened& opened, Time now);
  Verdict take_pong(const Opened& opened, Time now);
  void put(const detail::TileBlock& block, Time now);
  void note_wanted(Layer layer, std::int32_t tx, std::int32_t ty, std::uint32_t rev, Time now);
  void begin_boot(std::uint64_t boot_id, Time now);
  void log_once(unsigned kind, const char* text);

  State state_at(Time now) const;
  bool valid_at(Time now) const {
    const State at = state_at(now);
    return at == State::fresh || at == State::stale;
  }
  bool in_conflict(Time now) const { return has_conflict_ && now - conflict_at_ < detail::kLost; }
  Duration lost_after() const { return has_announce_ ? shorter(detail::kLost, announce_.lost_ms) : detail::kLost; }
  Duration stale_after() const { return has_announce_ ? shorter(detail::kStale, announce_.stale_ms) : detail::kStale; }
  /// What the node announces may shorten a limit, never lengthen it.
  static Duration shorter(Duration limit, std::uint32_t announced_ms) {
    return std::min<Duration>(limit, std::chrono::milliseconds(announced_ms));
  }
  Duration cell_max_age() const;
  bool readable(const detail::LayerTile& tile, const detail::Block& block, Duration max_age, Time now) const;
  bool find_cell(Layer layer, std::int64_t x, std::int64_t y, Time now, int& raw, const detail::Block*& block) const;
  static int raw_at(const std::uint8_t* cells, Layer layer, std::size_t i) {
    if (!detail::is_i16(layer)) return cells[i];
    return static_cast<std::int16_t>(detail::u16(cells + 2 * i));
  }
  static int unknown_raw(Layer layer) { return detail::is_i16(layer) ? -32768 : 255; }
  static float dequantise(Layer layer, int raw, const detail::Block& block, Time now);
  /// Calls draw(out index, raw, block) for every readable cell of the window.
  template <class Draw>
  void draw_layer(Layer layer, Time now, Draw draw) const;
  std::int64_t cell(double metres) const;

  std::size_t seal_request(std::uint8_t (&out)[detail::kMaxDatagramBytes], detail::Type type, std::size_t body_bytes);
  std::size_t write_subscribe(std::uint8_t (&out)[detail::kMaxDatagramBytes], std::uint64_t layers);
  std::size_t write_nack(std::uint8_t (&out)[detail::kMaxDatagramBytes], Time now);
  std::size_t nack_layer(std::uint8_t (&out)[detail::kMaxDatagramBytes], Layer layer, Time now);
  std::size_t write_ping(std::uint8_t (&out)[detail::kMaxDatagramBytes], Time now);

  struct OldBoot {
    std::uint64_t boot_id = 0;
    Time replaced;
  };

  Config config_;
  detail::TileStore store_;
  bool opened_ = false, subscribes_ = false, any_stream_ = false;
  std::uint32_t stream_id_ = 0;

  // of the present sender
  bool has_boot_ = false, has_announce_ = false, has_window_ = false, has_heartbeat_ = false, has_pose_ = false;
  bool tiles_forgotten_ = true;
  std::uint64_t boot_id_ = 0;
  detail::SequenceWindow sequence_;
  Announce announce_, next_announce_;
  Heartbeat heartbeat_, next_heartbeat_;
  Pose pose_, next_pose_;
  std::uint64_t announce_seq_ = 0, heartbeat_seq_ = 0, pose_seq_ = 0;
  Time heartbeat_at_, pose_at_, acquired_;
  int bye_ = -1;
  Opened newest_;  ///< header with the highest seq
  bool any_outdated_ = false;

  std::array<OldBoot, 8> old_boots_{};
  std::size_t boots_replaced_ = 0;
  std::uint64_t lost_before_ = 0;
  bool has_conflict_ = false;
  Time conflict_at_;
  State link_ = State::waiting;
  Origin origin_ = Origin::live;

  // requests
  std::uint64_t own_boot_id_ = 0, own_seq_ = 0, cookie_ = 0, nonce_ = 0;
  bool ping_waits_ = false;
  Time next_subscribe_, last_subscribe_, next_ping_, ping_at_;
  ClockOffset clock_;
  std::int64_t unix_offset_ns_ = 0;
  unsigned logged_ = 0;
};

// --- Receiver: opening ---

inline bool Receiver::open(const Config& config, Time now) {
  if (opened_) return fail("open", "one successful call an object", "a second one");
  config_ = config;
  config_.bind = config_.multicast = config_.node = nullptr;  // they are the caller's
  subscribes_ = config.node != nullptr;
  char number[32];
  const auto text = [&](long long value) { return std::snprintf(number, sizeof number, "%lld", value), number; };
  constexpr std::uint32_t kAllLayers = (1U << kLayers) - 1;
  if (config.layers == 0 || (config.layers & ~kAllLayers) != 0)
    return fail("layers", "a sum of layer_bit(...)", text(config.layers));
  if (config.accept_origins == 0 || config.accept_origins > 15)
    return fail("accept_origins", "a sum of origin_bit(...)", text(config.accept_origins));
  if (config.max_window_tiles == 0 || config.max_window_tiles > detail::kMaxWindowTiles)
    return fail("max_window_tiles", "1 to 4225", text(config.max_window_tiles));
  if (config.stream_id < Config::kAnyStream || config.stream_id > 0xFFFFFFFFLL)
    return fail("stream_id", "0 to 4294967295 or kAnyStream", text(config.stream_id));
  if (config.node != nullptr && config.stream_id == Config::kAnyStream)
    return fail("stream_id", "the stream to subscribe to", "kAnyStream");
  if (config.keys[0].id == 0 && config.keys[1].id != 0)
    return fail("keys", "the first key to be set before the second", "only the second");
  if (config.keys[0].id != 0 && config.keys[0].id == config.keys[1].id)
    return fail("keys", "two different ids", text(config.keys[0].id));
  if (config.repeats > 3) return fail("repeats", "0 to 3", text(config.repeats));
  if (config.cell_max_age < Duration{0}) return fail("cell_max_age", "0 or more", text(config.cell_max_age.count()));
  const auto index_ok = [](std::int64_t i) { return i >= -detail::kTileIndexLimit && i < detail::kTileIndexLimit; };
  if (!index_ok(config.tx_min) || !index_ok(config.ty_min) || !index_ok(config.tx_max) || !index_ok(config.ty_max) ||
      config.tx_max < config.tx_min || config.ty_max < config.ty_min)
    return fail("tx_min ... ty_max", "tiles from -2^26 to 2^26 - 1, minimum first", text(config.tx_min));
  if (!store_.allocate(config.max_window_tiles, config.layers))
    return fail("max_window_tiles", "so few that memory suffices", text(config.max_window_tiles));
  any_stream_ = config.stream_id == Config::kAnyStream;
  stream_id_ = any_stream_ ? 0 : static_cast<std::uint32_t>(config.stream_id);
  if (getrandom(&own_boot_id_, sizeof own_boot_id_, 0) != sizeof own_boot_id_ ||
      getrandom(&nonce_, sizeof nonce_, 0) != sizeof nonce_)
    return fail("getrandom", "random bytes from the kernel", "none");
  next_subscribe_ = next_ping_ = now;
  last_subscribe_ = now - detail::kSubscribeEvery;
  opened_ = true;
  return true;
}

inline void Receiver::log_once(unsigned kind, const char* text) {
  if (config_.log == nullptr || (logged_ & kind) != 0) return;
  logged_ |= kind;
  config_.log(config_.log_user, text);
}

// --- Receiver: taking datagrams ---

inline Verdict Receiver::accept(const std::uint8_t* data, std::size_t size, Time now) {
  advance(now);
  const Verdict verdict = judge(data, size, now);
  ++counters_.datagrams;
  ++counters_.by_verdict[static_cast<std::size_t>(verdict)];
  counters_.lost = lost_before_ + sequence_.lost();
  if (verdict == Verdict::origin)
    log_once(1, "scree: a map was refused for its origin (replay, sim or hil); see Config::accept_origins");
  if (verdict == Verdict::mac) log_once(2, "scree: a datagram was refused for its MAC; see Config::keys");
  advance(now);
  return verdict;
}

inline Verdict Receiver::judge(const std::uint8_t* data, std::size_t size, Time now) {
  Opened opened;
  Verdict verdict = detail::open_datagram(data, size, config_.keys, opened);
  if (verdict == Verdict::accepted) verdict = check_sender(opened, now);
  if (verdict == Verdict::accepted) verdict = take(opened, now);
  if (verdict != Verdict::accepted) return verdict;
  if (any_stream_) {
    any_stream_ = false;
    stream_id_ = opened.stream_id;
  }
  origin_ = opened.origin;
  if (opened.seq >= newest_.seq) {
    newest_ = opened;
    newest_.body = nullptr;  // it is the caller's
    acquired_ = now - std::chrono::microseconds(opened.age_us);
  }
  return verdict;
}

inline Verdict Receiver::check_sender(const Opened& opened, Time now) {
  if (!any_stream_ && opened.stream_id != stream_id_) return Verdict::stream;
  if ((config_.accept_origins & origin_bit(opened.origin)) == 0) return Verdict::origin;
  if (!has_boot_ || boot_id_ != opened.boot_id) {
    for (std::size_t i = 0; i < std::min(boots_replaced_, old_boots_.size()); ++i) {
      if (old_boots_[i].boot_id != opened.boot_id) continue;
      if (now - old_boots_[i].replaced > detail::kBootReorder) {
        has_conflict_ = true;
        conflict_at_ = now;
        log_once(4, "scree: two senders on one stream: the map is refused until one of them is silent");
      }
      return Verdict::old_boot;
    }
    // everything is forgotten for a new sender, so its first datagram must be good throughout
    const Verdict verdict = check_body(opened);
    if (verdict != Verdict::accepted) return verdict;
    begin_boot(opened.boot_id, now);
  }
  // outside of any stream: answers to somebody who has none (yet)
  if (opened.seq == 0 && (opened.type == detail::kCookie || opened.type == detail::kPong)) return Verdict::accepted;
  return sequence_.note(opened.seq) ? Verdict::accepted : Verdict::sequence;
}

inline Verdict Receiver::check_body(const Opened& opened) {
  detail::TileBlock block;
  detail::Manifest manifest;
  switch (opened.type) {
    case detail::kAnnounce:
      return decode_announce(opened, next_announce_);
    case detail::kTile:
      return decode_tile(opened, block, store_.scratch());
    case detail::kManifest:
      return decode_manifest(opened, manifest);
    case detail::kHeartbeat:
      return decode_heartbeat(opened, next_heartbeat_);
    case detail::kPose:
      return decode_pose(opened, next_pose_);
    case detail::kCookie:
      return decode_fixed(opened, detail::kCookieBytes);
    case detail::kPong:
      return decode_fixed(opened, detail::kPongBytes);
    case detail::kBye:
      return decode_fixed(opened, detail::kByeBytes);
    default:
      return Verdict::type;
  }
}

inline void Receiver::begin_boot(std::uint64_t boot_id, Time now) {
  if (has_boot_) {
    old_boots_[boots_replaced_++ % old_boots_.size()] = {boot_id_, now};
    link_ = State::lost;
  }
  lost_before_ += sequence_.lost();
  ++counters_.boots;
  has_boot_ = true;
  boot_id_ = boot_id;
  sequence_.reset();
  has_announce_ = has_window_ = has_heartbeat_ = has_pose_ = false;
  announce_seq_ = heartbeat_seq_ = pose_seq_ = 0;
  bye_ = -1;
  newest_ = Opened();
  store_.forget_window();
  any_outdated_ = false;
}

inline Verdict Receiver::take(const Opened& opened, Time now) {
  switch (opened.type) {
    case detail::kAnnounce:
      return take_announce(opened);
    case detail::kTile:
      return take_tile(opened, now);
    case detail::kManifest:
      return take_manifest(opened, now);
    case detail::kHeartbeat:
      return take_heartbeat(opened, now);
    case detail::kPose:
      return take_pose(opened, now);
    case detail::kCookie:
      return take_cookie(opened, now);
    case detail::kPong:
      return take_pong(opened, now);
    case detail::kBye: {
      const Verdict verdict = decode_fixed(opened, detail::kByeBytes);
      if (verdict == Verdict::accepted) bye_ = opened.body[0];
      return verdict;
    }
    default:
      return Verdict::type;
  }
}

inline Verdict Receiver::take_announce(const Opened& opened) {
  const Verdict verdict = decode_announce(opened, next_announce_);
  if (verdict != Verdict::accepted) return verdict;
  if (has_announce_ && opened.seq < announce_seq_) return verdict;  // a late one tells nothing new
  const Announce& next = next_announce_;
  if (has_announce_ && (announce_.map_id != next.map_id || announce_.resolution_m != next.resolution_m))
    store_.forget_tiles();
  const detail::TileWindow window{next.tx_min, next.ty_min, next.tx_max - next.tx_min + 1,
                                  next.ty_max - next.ty_min + 1};
  has_window_ = window.tiles() <= store_.max_tiles();
  if (has_window_) {
    store_.set_window(window);
  } else {
    store_.forget_window();
    ++counters_.windows_refused;
    log_once(8, "scree: the map's window is larger than Config::max_window_tiles: every cell is unknown");
  }
  announce_ = next;
  has_announce_ = true;
  announce_seq_ = opened.seq;
  return verdict;
}

inline Verdict Receiver::take_tile(const Opened& opened, Time now) {
  detail::TileBlock block;
  const Verdict verdict = decode_tile(opened, block, store_.scratch());
  if (verdict != Verdict::accepted) return verdict;
  if (!has_window_)
    ++counters_.tiles_without_window;
  else if (!store_.holds(block.layer))
    ++counters_.tiles_not_held;
  else if (!store_.window().contains(block.tx, block.ty))
    ++counters_.tiles_outside;
  else
    put(block, now);
  return verdict;
}

/// Keeps the block unless a newer revision is held. An equal one renews its age.
inline void Receiver::put(const detail::TileBlock& block, Time now) {
  detail::LayerTile& tile = *store_.find(block.layer, block.tx, block.ty);
  detail::Block& target = tile.block[block.half];
  if (target.held && block.rev < target.rev) {
    ++counters_.tiles_outdated;
    return;
  }
  ++counters_.tiles;
  target.held = true;
  target.rev = block.rev;
  target.age_ms = block.age_ms;
  target.scale = block.scale;
  target.offset = block.offset;
  target.arrived = now;
  tiles_forgotten_ = false;
  std::memcpy(store_.cells(block.layer, block.tx, block.ty) + block.half * detail::kTileArea, block.cells,
              detail::kTileArea);
  if (!tile.outdated) return;
  const std::uint32_t held = detail::held_rev(tile, block.layer);
  tile.outdated = held < tile.wanted_rev;
  if (held < tile.outdated_rev) return;
  tile.outdated_since = tile.wanted_since;
  tile.outdated_rev = tile.wanted_rev;
}

inline Verdict Receiver::take_manifest(const Opened& opened, Time now) {
  detail::Manifest manifest;
  const Verdict verdict = decode_manifest(opened, manifest);
  if (verdict != Verdict::accepted) return verdict;
  if (!has_window_) {
    ++counters_.manifests_without_window;
    return verdict;
  }
  const std::uint8_t* rev = manifest.revisions;
  for (std::int32_t r = 0; r < manifest.rows; ++r)
    for (std::int32_t c = 0; c < manifest.columns; ++c, rev += 4)
      note_wanted(manifest.layer, manifest.tx0 + c, manifest.ty0 + r, detail::u32(rev), now);
  return verdict;
}

inline void Receiver::note_wanted(Layer layer, std::int32_t tx, std::int32_t ty, std::uint32_t rev, Time now) {
  detail::LayerTile* const tile = store_.find(layer, tx, ty);
  if (tile == nullptr || rev <= tile->wanted_rev) return;
  // a subscription's region leaves the others out on purpose
  if (tx < config_.tx_min || tx > config_.tx_max || ty < config_.ty_min || ty > config_.ty_max) return;
  tile->wanted_rev = rev;
  tile->wanted_since = now;
  if (tile->outdated || detail::held_rev(*tile, layer) >= rev) return;
  tile->outdated = any_outdated_ = true;
  tiles_forgotten_ = false;
  tile->outdated_since = now;
  tile->outdated_rev = rev;
  tile->nack_at = std::max(tile->nack_at, now + detail::kNackAfter);
}

inline Verdict Receiver::take_heartbeat(const Opened& opened, Time now) {
  const Verdict verdict = decode_heartbeat(opened, next_heartbeat_);
  if (verdict != Verdict::accepted) return verdict;
  heartbeat_at_ = now;
  if (has_heartbeat_ && opened.seq < heartbeat_seq_) return verdict;
  heartbeat_ = next_heartbeat_;
  has_heartbeat_ = true;
  heartbeat_seq_ = opened.seq;
  return verdict;
}

inline Verdict Receiver::take_pose(const Opened& opened, Time now) {
  const Verdict verdict = decode_pose(opened, next_pose_);
  if (verdict != Verdict::accepted || (has_pose_ && opened.seq < pose_seq_)) return verdict;
  pose_ = next_pose_;
  pose_at_ = now;
  has_pose_ = true;
  pose_seq_ = opened.seq;
  return verdict;
}

inline Verdict Receiver::take_cookie(const Opened& opened, Time now) {
  const Verdict verdict = decode_fixed(opened, detail::kCookieBytes);
  if (verdict != Verdict::accepted) return verdict;
  const std::uint64_t cookie = detail::u64(opened.body);
  if (cookie != cookie_)
    next_subscribe_ = std::min(next_subscribe_, std::max(now, last_subscribe_ + detail::kCookieAnswer));
  cookie_ = cookie;
  return verdict;
}

inline Verdict Receiver::take_pong(const Opened& opened, Time now) {
  const Verdict verdict = decode_fixed(opened, detail::kPongBytes);
  if (verdict != Verdict::accepted) return verdict;
  const std::uint8_t* const p = opened.body;
  if (!ping_waits_ || detail::u64(p) != nonce_) {
    ++counters_.pongs_unasked;
    return verdict;
  }
  ping_waits_ = false;
  // unsigned: what a sender puts there may not make a sum of ours undefined
  const auto sent = static_cast<std::uint64_t>(ping_at_.time_since_epoch().count() + unix_offset_ns_);
  const auto arrived = static_cast<std::uint64_t>(now.time_since_epoch().count() + unix_offset_ns_);
  const std::uint64_t received = detail::u64(p + 16), answered = detail::u64(p + 24);
  clock_.offset_ns = static_cast<std::int64_t>(received - sent) / 2 + static_cast<std::int64_t>(answered - arrived) / 2;
  clock_.round_trip_ns = static_cast<std::int64_t>((arrived - sent) - (answered - received));
  clock_.known = true;
  return verdict;
}

// --- Receiver: freshness ---

inline State Receiver::state_at(Time now) const {
  if (!has_boot_) return State::waiting;
  if (bye_ >= 0 || (newest_.health & kFault) != 0 || in_conflict(now)) return State::lost;
  if (!has_heartbeat_) return link_ == State::waiting ? State::waiting : State::lost;
  const Duration silence = now - heartbeat_at_;
  if (silence >= lost_after()) return State::lost;
  return silence >= stale_after() ? State::stale : State::fresh;
}

inline void Receiver::advance(Time now) {
  link_ = state_at(now);
  // after a silence the map comes back with the refresh, not before
  if (has_heartbeat_ && !tiles_forgotten_ && now - heartbeat_at_ >= lost_after()) {
    store_.forget_tiles();
    any_outdated_ = false;
    tiles_forgotten_ = true;
  }
}

inline Duration Receiver::cell_max_age() const {
  const Duration announced = std::chrono::milliseconds(has_announce_ ? announce_.cell_max_age_ms : 0);
  if (config_.cell_max_age == Duration{0}) return announced;
  return announced == Duration{0} ? config_.cell_max_age : std::min(config_.cell_max_age, announced);
}

inline bool Receiver::readable(const detail::LayerTile& tile, const detail::Block& block, Duration max_age,
                               Time now) const {
  if (!block.held || (tile.outdated && now - tile.outdated_since > detail::kOutdated)) return false;
  return max_age == Duration{0} || std::chrono::milliseconds(block.age_ms) + (now - block.arrived) <= max_age;
}

inline Duration Receiver::data_age(Time now) const {
  return newest_.t_data_ns == 0 ? Duration::max() : now - acquired_;
}

inline bool Receiver::pose(Pose& out, Time now) const {
  if (!has_pose_) return false;
  out = pose_;
  out.age += now - pose_at_;
  return true;
}

// --- Receiver: reading ---

inline std::int64_t Receiver::cell(double metres) const {
  const double index = has_announce_ ? std::floor(metres / announce_.resolution_m) : std::nan("");
  constexpr double kFar = 4e18;
  return std::abs(index) <= kFar ? static_cast<std::int64_t>(index) : std::numeric_limits<std::int64_t>::max();
}

inline bool Receiver::find_cell(Layer layer, std::int64_t x, std::int64_t y, Time now, int& raw,
                                const detail::Block*& block) const {
  if (!has_window_ || !valid_at(now)) return false;
  const Announce& a = announce_;
  if (x < a.x_min_cells || x >= a.x_min_cells + std::int64_t{a.columns}) return false;
  if (y < a.y_min_cells || y >= a.y_min_cells + std::int64_t{a.rows}) return false;
  const std::int64_t tx = x >> detail::kTileLog2, ty = y >> detail::kTileLog2;
  const detail::LayerTile* const tile = store_.find(layer, tx, ty);
  if (tile == nullptr) return false;
  const std::size_t row = static_cast<std::size_t>(y & 31), column = static_cast<std::size_t>(x & 31);
  block = &tile->block[detail::is_i16(layer) && row >= 16 ? 1 : 0];
  if (!readable(*tile, *block, cell_max_age(), now)) return false;
  raw = raw_at(store_.cells(layer, tx, ty), layer, row * 32 + column);
  return raw != unknown_raw(layer);
}

inline float Receiver::dequantise(Layer layer, int raw, const detail::Block& block, Time now) {
  const float value = block.offset + block.scale * static_cast<float>(raw);
  if (layer != Layer::cell_age) return value;
  const Duration since = std::chrono::milliseconds(block.age_ms) + (now - block.arrived);
  return value + std::chrono::duration<float>(since).count();
}

inline int Receiver::cost_of_cell(std::int64_t x_cells, std::int64_t y_cells, Time now) const {
  int raw = kCostUnknown;
  const detail::Block* block = nullptr;
  return find_cell(Layer::cost, x_cells, y_cells, now, raw, block) ? raw : kCostUnknown;
}

inline float Receiver::value_of_cell(Layer layer, std::int64_t x_cells, std::int64_t y_cells, Time now) const {
  int raw = 0;
  const detail::Block* block = nullptr;
  if (!find_cell(layer, x_cells, y_cells, now, raw, block)) return std::numeric_limits<float>::quiet_NaN();
  return dequantise(layer, raw, *block, now);
}

inline CellState Receiver::cell_state_of_cell(std::int64_t x_cells, std::int64_t y_cells, Time now) const {
  int raw = 0;
  const detail::Block* block = nullptr;
  const bool known = find_cell(Layer::cell_state, x_cells, y_cells, now, raw, block) && raw <= 4;
  return known ? static_cast<CellState>(raw) : CellState::never_seen;
}

inline Grid Receiver::grid() const {
  Grid out;
  if (!has_window_) return out;
  out.resolution_m = announce_.resolution_m;
  out.x_min_cells = announce_.x_min_cells;
  out.y_min_cells = announce_.y_min_cells;
  out.x_min_m = out.x_min_cells * out.resolution_m;
  out.y_min_m = out.y_min_cells * out.resolution_m;
  out.columns = announce_.columns;
  out.rows = announce_.rows;
  return out;
}

template <class Draw>
void Receiver::draw_layer(Layer layer, Time now, Draw draw) const {
  if (!has_window_ || !store_.holds(layer) || !valid_at(now)) return;
  const Announce& a = announce_;
  const std::int64_t x_end = a.x_min_cells + std::int64_t{a.columns}, y_end = a.y_min_cells + std::int64_t{a.rows};
  const Duration max_age = cell_max_age();
  for (std::int64_t ty = a.ty_min; ty <= a.ty_max; ++ty) {
    for (std::int64_t tx = a.tx_min; tx <= a.tx_max; ++tx) {
      const detail::LayerTile& tile = *store_.find(layer, tx, ty);
      const std::uint8_t* const cells = store_.cells(layer, tx, ty);
      const std::int64_t x_begin = std::max<std::int64_t>(tx * 32, a.x_min_cells);
      for (std::int64_t y = std::max<std::int64_t>(ty * 32, a.y_min_cells); y < std::min(ty * 32 + 32, y_end); ++y) {
        const detail::Block& block = tile.block[detail::is_i16(layer) && (y & 31) >= 16 ? 1 : 0];
        if (!readable(tile, block, max_age, now)) continue;
        auto out = static_cast<std::size_t>((y - a.y_min_cells) * a.columns + (x_begin - a.x_min_cells));
        auto in = static_cast<std::size_t>((y & 31) * 32 + (x_begin & 31));
        for (std::int64_t x = x_begin; x < std::min(tx * 32 + 32, x_end); ++x, ++in, ++out)
          draw(out, raw_at(cells, layer, in), block);
      }
    }
  }
}

inline bool Receiver::copy_cost(std::uint8_t* out, std::size_t capacity, Time now) const {
  if (!has_window_ || capacity < grid().cells()) return false;
  std::memset(out, kCostUnknown, grid().cells());
  draw_layer(Layer::cost, now,
             [out](std::size_t i, int raw, const detail::Block&) { out[i] = static_cast<std::uint8_t>(raw); });
  return true;
}

inline bool Receiver::copy_layer(Layer layer, float* out, std::size_t capacity, Time now) const {
  if (!has_window_ || capacity < grid().cells()) return false;
  std::fill_n(out, grid().cells(), std::numeric_limits<float>::quiet_NaN());
  draw_layer(layer, now, [=](std::size_t i, int raw, const detail::Block& block) {
    if (raw != unknown_raw(layer)) out[i] = dequantise(layer, raw, block, now);
  });
  return true;
}

inline bool Receiver::to_occupancy(std::int8_t* out, std::size_t capacity, Time now) const {
  if (!has_window_ || capacity < grid().cells()) return false;
  std::memset(out, -1, grid().cells());
  draw_layer(Layer::cost, now, [out](std::size_t i, int raw, const detail::Block&) { out[i] = occupancy(raw); });
  return true;
}

// --- Receiver: requests ---

inline std::size_t Receiver::seal_request(std::uint8_t (&out)[detail::kMaxDatagramBytes], detail::Type type,
                                          std::size_t body_bytes) {
  const Key& key = config_.keys[0];
  const std::size_t end = detail::kHeaderBytes + body_bytes;
  const std::size_t total = end + (key.id != 0 ? detail::kMacBytes : 0);
  std::memset(out, 0, detail::kHeaderBytes);
  std::memcpy(out, "SCRE", 4);
  out[4] = 1;
  out[6] = type;
  out[7] = key.id != 0 ? 1 : 0;
  detail::put(out + 8, detail::kHeaderBytes, 2);
  detail::put(out + 10, total, 2);
  detail::put(out + 12, stream_id_, 4);
  detail::put(out + 16, own_boot_id_, 8);
  detail::put(out + 24, ++own_seq_, 8);
  detail::put(out + 56, key.id, 2);
  detail::put(out + 60, detail::datagram_crc(out, end), 4);
  if (key.id != 0) {
    std::uint8_t mac[detail::kMacBytes];
    detail::datagram_mac(key, out, end, mac);
    std::memcpy(out + end, mac, sizeof mac);
  }
  return total;
}

inline std::size_t Receiver::next_request(std::uint8_t (&out)[detail::kMaxDatagramBytes], Time now) {
  if (!subscribes_) return 0;
  if (now >= next_subscribe_) {
    last_subscribe_ = now;
    next_subscribe_ = now + detail::kSubscribeEvery;
    ++counters_.subscribes_sent;
    return write_subscribe(out, config_.layers);
  }
  if (cookie_ == 0) return 0;
  if (any_outdated_ && valid_at(now)) {
    const std::size_t size = write_nack(out, now);
    if (size > 0) return size;
  }
  return now >= next_ping_ ? write_ping(out, now) : 0;
}

inline std::size_t Receiver::end_request(std::uint8_t (&out)[detail::kMaxDatagramBytes]) {
  if (!subscribes_ || cookie_ == 0) return 0;
  ++counters_.subscribes_sent;
  return write_subscribe(out, 0);
}

inline std::size_t Receiver::write_subscribe(std::uint8_t (&out)[detail::kMaxDatagramBytes], std::uint64_t layers) {
  std::uint8_t* const body = out + detail::kHeaderBytes;
  std::memset(body, 0, 40);
  detail::put(body, cookie_, 8);
  detail::put(body + 8, layers, 8);
  const std::int32_t region[4] = {config_.tx_min, config_.ty_min, config_.tx_max, config_.ty_max};
  for (std::size_t i = 0; i < 4; ++i) detail::put(body + 16 + 4 * i, static_cast<std::uint32_t>(region[i]), 4);
  detail::put(body + 32, config_.datagrams_per_s, 4);
  body[36] = config_.repeats;
  return seal_request(out, detail::kSubscribe, 40);
}

inline std::size_t Receiver::write_nack(std::uint8_t (&out)[detail::kMaxDatagramBytes], Time now) {
  for (std::size_t i = 0; i < kLayers; ++i) {
    const auto layer = static_cast<Layer>(i);
    if (!store_.holds(layer)) continue;
    const std::size_t size = nack_layer(out, layer, now);
    if (size > 0) return size;
  }
  return 0;
}

/// Up to 128 tiles of one layer whose time has come; 0 when there are none.
inline std::size_t Receiver::nack_layer(std::uint8_t (&out)[detail::kMaxDatagramBytes], Layer layer, Time now) {
  constexpr std::size_t kMaxTiles = 128;
  std::uint8_t* const body = out + detail::kHeaderBytes;
  const detail::TileWindow& window = store_.window();
  std::size_t count = 0;
  for (std::int32_t y = window.ty; y < window.ty + window.rows; ++y) {
    for (std::int32_t x = window.tx; x < window.tx + window.columns && count < kMaxTiles; ++x) {
      detail::LayerTile& tile = *store_.find(layer, x, y);
      if (!tile.outdated || now < tile.nack_at) continue;
      tile.nack_at = now + detail::kNackAgain;
      detail::put(body + 16 + 8 * count, static_cast<std::uint32_t>(x), 4);
      detail::put(body + 20 + 8 * count, static_cast<std::uint32_t>(y), 4);
      ++count;
    }
  }
  if (count == 0) return 0;
  std::memset(body, 0, 16);
  detail::put(body, cookie_, 8);
  body[8] = static_cast<std::uint8_t>(layer);
  body[9] = static_cast<std::uint8_t>(count);
  ++counters_.nacks_sent;
  counters_.tiles_nacked += count;
  return seal_request(out, detail::kNack, 16 + 8 * count);
}

inline std::size_t Receiver::write_ping(std::uint8_t (&out)[detail::kMaxDatagramBytes], Time now) {
  std::uint8_t* const body = out + detail::kHeaderBytes;
  next_ping_ = now + detail::kPingEvery;
  ping_at_ = now;
  ping_waits_ = true;
  nonce_ = nonce_ * 6364136223846793005U + 1442695040888963407U;  // from a random start; its guessing gains nothing
  std::memset(body, 0, 32);
  detail::put(body, nonce_, 8);
  detail::put(body + 8, static_cast<std::uint64_t>(now.time_since_epoch().count() + unix_offset_ns_), 8);
  ++counters_.pings_sent;
  return seal_request(out, detail::kPing, 32);
}

// --- sockets ---

namespace detail {

struct Address {
  sockaddr_storage storage{};
  socklen_t size = 0;
  sockaddr* get() { return reinterpret_cast<sockaddr*>(&storage); }
  bool v6() const { return storage.ss_family == AF_INET6; }

  /// "127.0.0.1:47800" or "[::1]:47800"; names are not looked up.
  bool parse(const char* text) {
    char host[64];
    const char* const colon = std::strrchr(text, ':');
    if (colon == nullptr || colon[1] < '0' || colon[1] > '9') return false;
    char* end = nullptr;
    const unsigned long port = std::strtoul(colon + 1, &end, 10);
    std::size_t length = static_cast<std::size_t>(colon - text);
    if (*end != '\0' || port > 65535 || length >= sizeof host) return false;
    if (length > 2 && text[0] == '[' && text[length - 1] == ']') {
      ++text;
      length -= 2;
    }
    std::memcpy(host, text, length);
    host[length] = '\0';
    return parse_host(host, static_cast<std::uint16_t>(port));
  }
  bool parse_host(const char* host, std::uint16_t port) {
    sockaddr_in four{};
    sockaddr_in6 six{};
    if (inet_pton(AF_INET, host, &four.sin_addr) == 1) {
      four.sin_family = AF_INET;
      four.sin_port = htons(port);
      size = sizeof four;
      std::memcpy(&storage, &four, sizeof four);
      return true;
    }
    if (inet_pton(AF_INET6, host, &six.sin6_addr) != 1) return false;
    six.sin6_family = AF_INET6;
    six.sin6_port = htons(port);
    size = sizeof six;
    std::memcpy(&storage, &six, sizeof six);
    return true;
  }
  sockaddr_in four() const {
    sockaddr_in out;
    std::memcpy(&out, &storage, sizeof out);
    return out;
  }
  sockaddr_in6 six() const {
    sockaddr_in6 out;
    std::memcpy(&out, &storage, sizeof out);
    return out;
  }
  std::uint16_t port() const { return ntohs(v6() ? six().sin6_port : four().sin_port); }
  /// 0.0.0.0 or [::]: every interface at once.
  bool any() const {
    if (!v6()) return four().sin_addr.s_addr == 0;
    const in6_addr address = six().sin6_addr;
    return IN6_IS_ADDR_UNSPECIFIED(&address) != 0;
  }
};

}  // namespace detail

/// A Receiver with its socket.
class Client : public Receiver {
 public:
  Client() = default;
  ~Client() { close(); }

  /// Binds and, with Config::node, begins to subscribe. False: error() says why, and it may be tried again. An object
  /// is opened once.
  bool open(const Config& config, Time now = Clock::now());
  /// Ends the subscription and closes the socket. Readings go on to age.
  void close();

  /// Takes what has arrived (at most 4096 datagrams a call), applies the rules of time, sends requests that are due.
  /// Never blocks. Call it at least every 50 ms. True when something arrived.
  bool poll(Time now = Clock::now());
  /// Sleeps until something arrives, at most for `timeout`. Do not sleep longer than 50 ms when subscribed: NACKs wait.
  bool wait(std::chrono::milliseconds timeout) const;
  /// For select, poll or epoll; -1 while closed.
  int fd() const { return fd_; }
  std::uint16_t port() const { return port_; }  ///< the one that is bound

 private:
  static constexpr std::size_t kBatch = 32;
  static constexpr std::size_t kSlotBytes = 1280;  // more than a datagram may have: longer ones show
  static constexpr std::size_t kMaxPerPoll = 4096;
  static constexpr std::size_t kControlBytes = CMSG_SPACE(sizeof(std::uint32_t)) + CMSG_SPACE(sizeof(timespec));

  bool make_socket(const char* what, detail::Address& local);
  bool join(const Config& config, const detail::Address& local);
  /// Not strerror, which threads may not share.
  bool fail_errno(const char* what) {
    char number[24];
    std::snprintf(number, sizeof number, "errno %d", errno);
    return fail(what, "an address of this machine and a free port",
                errno == EADDRINUSE      ? "in use"
                : errno == EADDRNOTAVAIL ? "no such address here"
                : errno == EACCES        ? "not permitted"
                                         : number);
  }
  int receive_batch();
  Time arrival(msghdr& message, Time now, std::int64_t unix_ns);
  void send_requests(Time now);

  int fd_ = -1;
  std::uint16_t port_ = 0;
  detail::Address node_;
  Time drained_;  ///< when the socket was last seen empty: what comes later arrived later
  Time last_arrival_;
  bool stamped_ = false;  ///< a datagram had a stamp from before it was read
  std::uint8_t slots_[kBatch][kSlotBytes]{};
  alignas(cmsghdr) std::uint8_t control_[kBatch][kControlBytes]{};
  mmsghdr messages_[kBatch]{};
  iovec vectors_[kBatch]{};
};

inline bool Client::open(const Config& config, Time now) {
  if (fd_ >= 0) return fail("open", "one successful call an object", "a second one");
  detail::Address local;
  if (config.bind == nullptr || !local.parse(config.bind))
    return fail("bind", "a numeric ADDRESS:PORT", config.bind == nullptr ? "nothing" : config.bind);
  if (local.any()) return fail("bind", "one address of this machine, not all of them", config.bind);
  if (config.multicast != nullptr && config.node != nullptr)
    return fail("node", "no subscription to a multicast group", config.node);
  if (config.node != nullptr && (!node_.parse(config.node) || node_.any() || node_.v6() != local.v6()))
    return fail("node", "a numeric ADDRESS:PORT of the same family as bind", config.node);
  detail::Address bound = local;
  if (config.multicast != nullptr && (local.v6() || !bound.parse_host(config.multicast, local.port()) || bound.v6() ||
                                      !IN_MULTICAST(ntohl(bound.four().sin_addr.s_addr))))
    return fail("multicast", "an IPv4 group, 224.0.0.0 to 239.255.255.255", config.multicast);
  if (!make_socket(config.bind, bound) || (config.multicast != nullptr && !join(config, local)) ||
      !Receiver::open(config, now)) {
    close();
    return false;
  }
  drained_ = last_arrival_ = now;
  return true;
}

inline bool Client::make_socket(const char* what, detail::Address& local) {
  fd_ = ::socket(local.v6() ? AF_INET6 : AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (fd_ < 0) return fail_errno("socket");
  const int on = 1, buffer = 8 << 20;  // the kernel gives what net.core.rmem_max allows
  const bool group = !local.v6() && IN_MULTICAST(ntohl(local.four().sin_addr.s_addr));
  // a group may have several listeners on a machine; an address of its own may not, or one could steal from another
  if (group) (void)::setsockopt(fd_, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  (void)::setsockopt(fd_, SOL_SOCKET, SO_RCVBUF, &buffer, sizeof buffer);
  (void)::setsockopt(fd_, SOL_SOCKET, SO_RXQ_OVFL, &on, sizeof on);
  (void)::setsockopt(fd_, SOL_SOCKET, SO_TIMESTAMPNS, &on, sizeof on);
  if (::bind(fd_, local.get(), local.size) != 0) return fail_errno(what);
  detail::Address actual;
  actual.size = sizeof actual.storage;
  if (::getsockname(fd_, actual.get(), &actual.size) != 0) return fail_errno("getsockname");
  port_ = actual.port();
  return true;
}

inline bool Client::join(const Config& config, const detail::Address& local) {
  ip_mreq request{};
  (void)inet_pton(AF_INET, config.multicast, &request.imr_multiaddr);
  request.imr_interface = local.four().sin_addr;
  if (::setsockopt(fd_, IPPROTO_IP, IP_ADD_MEMBERSHIP, &request, sizeof request) != 0)
    return fail_errno(config.multicast);
  return true;
}

inline void Client::close() {
  if (fd_ < 0) return;
  std::uint8_t out[detail::kMaxDatagramBytes];
  const std::size_t size = end_request(out);
  if (size > 0 && ::sendto(fd_, out, size, MSG_DONTWAIT, node_.get(), node_.size) < 0) ++counters_.send_errors;
  (void)::close(fd_);
  fd_ = -1;
}

inline int Client::receive_batch() {
  for (std::size_t i = 0; i < kBatch; ++i) {
    vectors_[i] = {slots_[i], kSlotBytes};
    messages_[i] = {};
    messages_[i].msg_hdr.msg_iov = &vectors_[i];
    messages_[i].msg_hdr.msg_iovlen = 1;
    messages_[i].msg_hdr.msg_control = control_[i];
    messages_[i].msg_hdr.msg_controllen = kControlBytes;
  }
  return ::recvmmsg(fd_, messages_, kBatch, MSG_DONTWAIT, nullptr);
}

/// When the kernel got it, on this clock: a datagram that waited in the buffer is as old as it is. Where the kernel's
/// clock disagrees, not before the buffer was last empty and not after now. The kernel begins to stamp a moment after
/// it was told to, and gives what it did not stamp the time of reading: that may be as old as the buffer.
inline Time Client::arrival(msghdr& message, Time now, std::int64_t unix_ns) {
  Time when = now;
  for (cmsghdr* item = CMSG_FIRSTHDR(&message); item != nullptr; item = CMSG_NXTHDR(&message, item)) {
    if (item->cmsg_level != SOL_SOCKET) continue;
    if (item->cmsg_type == SO_RXQ_OVFL) {
      std::uint32_t total = 0;
      std::memcpy(&total, CMSG_DATA(item), sizeof total);
      counters_.overflowed = total;
    } else if (item->cmsg_type == SCM_TIMESTAMPNS) {
      timespec stamp{};
      std::memcpy(&stamp, CMSG_DATA(item), sizeof stamp);
      const std::int64_t age_ns = unix_ns - (std::int64_t{stamp.tv_sec} * 1'000'000'000 + stamp.tv_nsec);
      stamped_ = stamped_ || age_ns > 0;
      when = stamped_ ? now - Duration(age_ns) : drained_;
    }
  }
  last_arrival_ = std::min(std::max({when, drained_, last_arrival_}), std::max(now, last_arrival_));
  return last_arrival_;
}

inline bool Client::poll(Time now) {
  if (fd_ < 0) return false;
  timespec real{};
  (void)::clock_gettime(CLOCK_REALTIME, &real);
  const std::int64_t unix_ns = std::int64_t{real.tv_sec} * 1'000'000'000 + real.tv_nsec;
  set_unix_offset(unix_ns - now.time_since_epoch().count());
  std::size_t taken = 0;
  while (taken < kMaxPerPoll) {
    const int count = receive_batch();
    if (count < 0 && (errno == EINTR || errno == ECONNREFUSED)) continue;  // the node is not there (yet)
    if (count < 0 && errno != EAGAIN && errno != EWOULDBLOCK) ++counters_.receive_errors;
    for (std::size_t i = 0; count > 0 && i < static_cast<std::size_t>(count); ++i)
      (void)accept(slots_[i], messages_[i].msg_len, arrival(messages_[i].msg_hdr, now, unix_ns));
    if (count > 0) taken += static_cast<std::size_t>(count);
    if (count < static_cast<int>(kBatch)) {
      drained_ = std::max(now, last_arrival_);
      break;
    }
  }
  advance(std::max(now, last_arrival_));
  send_requests(std::max(now, last_arrival_));
  return taken > 0;
}

inline void Client::send_requests(Time now) {
  std::uint8_t out[detail::kMaxDatagramBytes];
  for (std::size_t size = next_request(out, now); size > 0; size = next_request(out, now))
    if (::sendto(fd_, out, size, MSG_DONTWAIT, node_.get(), node_.size) < 0 && errno != ECONNREFUSED)
      ++counters_.send_errors;
}

inline bool Client::wait(std::chrono::milliseconds timeout) const {
  pollfd waiting{fd_, POLLIN, 0};
  const auto limit = std::min<std::int64_t>(std::max<std::int64_t>(timeout.count(), 0), 1 << 30);
  return ::poll(&waiting, fd_ < 0 ? 0 : 1, static_cast<int>(limit)) > 0;
}

}  // namespace client
}  // namespace scree

#endif  // SCREE_CLIENT_HPP
