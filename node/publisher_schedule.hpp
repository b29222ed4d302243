#pragma once
// When what is sent. The sockets are below (Outbox), the tiles beside it (TileBook).

#include <functional>
#include <memory>

#include "node/publisher.hpp"
#include "node/publisher_outbox.hpp"
#include "node/publisher_pacing.hpp"
#include "node/tile_book.hpp"

namespace scree::node {

inline constexpr Duration kHeartbeatPeriod = std::chrono::milliseconds(100);
inline constexpr Duration kAnnouncePeriod = std::chrono::seconds(1);
inline constexpr Duration kManifestPeriod = std::chrono::milliseconds(100);
inline constexpr double kManifestShare = 0.25;  ///< of the pacing, at most

struct Publisher::State {
  State(UdpSocket socket, const config::PublishSettings& publish, drivers::Origin origin, double cell_m,
        std::uint32_t config_hash);

  /// Everything but type and seq.
  protocol::Header header(MonotonicTime now) const;

  void send_heartbeat(MonotonicTime now);
  void send_announce(MonotonicTime now);
  void send_periodic(MonotonicTime now);  ///< heartbeat and announcement, when due
  /// Asks `room` before each datagram; false when there was none: the manifests are still to be sent.
  bool send_manifests(MonotonicTime now, const std::function<bool()>& room);
  void send_tiles(MonotonicTime now);
  void send_unit(MonotonicTime now, TileUnit& unit);
  void send_bye(MonotonicTime now, protocol::ByeReason reason, int copy);

  Duration tick(MonotonicTime now, const NodeStatus& status);
  Duration until_due(MonotonicTime now) const;
  /// As soon as all of a revision is out, and every 100 ms whatever is still waiting; both only as often as leaves
  /// three quarters of the pacing to others.
  MonotonicTime manifest_due() const {
    return manifest_wanted && !book.has_pending() ? earliest_manifest : next_manifest;
  }
  Duration refresh_interval() const;
  std::uint32_t refresh_ms() const;
  bool make_room(std::size_t datagrams) {
    return outbox.room() >= datagrams || (outbox.flush() && outbox.room() >= datagrams);
  }
  void collect_counters();

  // of the end (publisher_finish.cpp); they sleep
  bool wait_for_room(std::size_t datagrams);  ///< false: the kernel took nothing for 2 s
  bool send_pending();                        ///< false: no block could be sent for 2 s
  bool send_farewell(protocol::ByeReason reason, bool patient);

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
  MonotonicTime earliest_manifest;  // by their share of the pacing
  MonotonicTime next_manifest;
  MonotonicTime next_refresh;
  bool announced_window = false;  // the window is the one last announced
  bool manifest_wanted = false;   // a new revision is waiting for its manifest
  bool refresh_turn = false;      // changed and refreshed units take turns when both are due
  PublisherCounters counters;
};

}  // namespace scree::node
