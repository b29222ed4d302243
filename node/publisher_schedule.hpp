#pragma once
// When what is sent. The sockets are below (Outbox), the tiles beside it (TileBook).

#include <memory>

#include "node/publisher.hpp"
#include "node/publisher_outbox.hpp"
#include "node/publisher_pacing.hpp"
#include "node/tile_book.hpp"

namespace scree::node {

inline constexpr Duration kHeartbeatPeriod = std::chrono::milliseconds(100);
inline constexpr Duration kAnnouncePeriod = std::chrono::seconds(1);
inline constexpr Duration kManifestPeriod = std::chrono::milliseconds(100);

struct Publisher::State {
  State(UdpSocket socket, const config::PublishSettings& publish, drivers::Origin origin, double cell_m,
        std::uint32_t config_hash);

  /// Everything but type and seq.
  protocol::Header header(MonotonicTime now) const;

  void send_heartbeat(MonotonicTime now);
  void send_announce(MonotonicTime now);
  void send_manifests(MonotonicTime now);
  void send_tiles(MonotonicTime now);
  void send_unit(MonotonicTime now, TileUnit& unit);
  void send_bye(MonotonicTime now, protocol::ByeReason reason, int copy);

  Duration tick(MonotonicTime now, const NodeStatus& status);
  Duration until_due(MonotonicTime now) const;
  Duration refresh_interval() const;
  std::uint32_t refresh_ms() const;
  bool make_room(std::size_t datagrams) {
    return outbox.room() >= datagrams || (outbox.flush() && outbox.room() >= datagrams);
  }
  void collect_counters();

  config::PublishSettings settings;
  double cell_m;
  protocol::Header base;
  Outbox outbox;
  TokenBucket bucket;
  TileBook book;

  // of the newest snapshot
  bool has_map = false;
  LatticeWindow window;
  std::uint32_t revision = 0;
  Time data_time;
  MonotonicTime received;

  NodeStatus status;
  MonotonicTime started;
  MonotonicTime next_heartbeat;  // the epoch: due at once
  MonotonicTime next_announce;
  MonotonicTime next_manifest;
  MonotonicTime next_refresh;
  bool announced_window = false;  // the window is the one last announced
  bool manifest_wanted = false;   // a new revision is waiting for its manifest
  bool refresh_turn = false;      // changed and refreshed units take turns when both are due
  PublisherCounters counters;
};

}  // namespace scree::node
