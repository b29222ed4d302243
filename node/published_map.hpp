#pragma once
// What every destination sends from: the newest map in tiles, and what the node says of itself.

#include <array>
#include <cstdint>
#include <optional>

#include "config/settings.hpp"
#include "core/time.hpp"
#include "mapping/snapshot.hpp"
#include "node/latency.hpp"
#include "node/protocol.hpp"
#include "node/tile_book.hpp"

namespace scree::node {

/// What a heartbeat tells of the node.
struct NodeStatus {
  std::uint64_t frames_in = 0;
  std::uint64_t frames_dropped = 0;
  std::uint16_t health = 0;  ///< bits of the common header (protocol::Health)
  std::array<protocol::SensorReport, protocol::kMaxSensors> sensors{};
  std::uint8_t sensor_count = 0;
  std::optional<drivers::Origin> origin;  ///< set: of the frames, in place of what Publisher::open was told
};

struct PublisherCounters {
  std::uint64_t datagrams = 0;  ///< to all destinations, as everything here
  std::uint64_t bytes = 0;
  std::uint64_t send_errors = 0;           ///< refused by the kernel: too long, no route, not permitted
  std::uint64_t send_blocked = 0;          ///< times that the kernel's buffer was full; nothing is lost by it
  std::uint64_t blocks = 0;                ///< TILE datagrams
  std::uint64_t blocks_refreshed = 0;      ///< of these, unchanged since they were last sent
  std::uint64_t blocks_repeated = 0;       ///< of these, copies that a subscriber asked for
  std::uint64_t poses = 0;                 ///< POSE datagrams
  std::uint64_t poses_superseded = 0;      ///< not sent: the pacing left no room before 64 later ones came
  std::uint64_t snapshots = 0;             ///< submitted
  std::uint64_t snapshots_superseded = 0;  ///< replaced before all of their changes were sent
  std::uint64_t snapshots_refused = 0;     ///< empty, more than kMaxWindowTiles, or another cell size than announced
  std::uint64_t cells_saturated = 0;       ///< values moved to the end of their layer's range, over all snapshots
};

/// The poses of the frames fused last; each destination sends those it has not sent.
class PoseLog {
 public:
  static constexpr std::uint64_t kKept = 64;
  struct Entry {
    protocol::PoseMessage message;
    MonotonicTime delivered;  ///< to the node
  };

  void add(const Entry& entry) { entries_[count_++ % kKept] = entry; }
  std::uint64_t count() const { return count_; }  ///< ever added
  std::uint64_t oldest() const { return count_ > kKept ? count_ - kKept : 0; }
  const Entry& operator[](std::uint64_t i) const { return entries_[i % kKept]; }  ///< oldest() … count() − 1

 private:
  std::array<Entry, kKept> entries_{};
  std::uint64_t count_ = 0;
};

struct PublishedMap {
  config::PublishSettings settings;
  double cell_m = 0.1;
  protocol::Header base;   ///< what never changes
  protocol::KeyRing keys;  ///< the first signs what is sent
  TileBook book;

  // of the newest snapshot
  bool has_map = false;
  LatticeWindow window;
  std::uint32_t revision = 0;
  Time data_time;
  MonotonicTime received;
  std::uint64_t generation = 0;  ///< snapshots taken

  PoseLog poses;
  NodeStatus status;
  LatencyHistogram latency;  ///< frame in to last changed block out, at the configured destination
  MonotonicTime started;
  PublisherCounters counters;

  void take(const mapping::MapSnapshot& snapshot);
  /// Once a tick: what is asked of the system, so that its cost does not grow with the destinations.
  void look_at_system(MonotonicTime now);

  /// Everything but type and seq.
  protocol::Header header(MonotonicTime now) const;
  protocol::Heartbeat heartbeat(MonotonicTime now) const;
  /// Of the layers in `mask`.
  protocol::Announce announce(std::uint64_t layer_mask, std::uint32_t refresh_ms) const;

 private:
  std::uint64_t rss_bytes_ = 0;
  MonotonicTime next_look_;
};

/// Bit of a layer in a layer mask.
constexpr std::uint64_t layer_bit(protocol::Layer layer) {
  return std::uint64_t{1} << static_cast<unsigned>(layer);
}

}  // namespace scree::node
