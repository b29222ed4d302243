#pragma once
// Sends the map as datagrams: announce, tiles on change and by cyclic refresh, manifests, heartbeats, BYE.
// Single-threaded: the publish thread owns it.

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "config/settings.hpp"
#include "core/result.hpp"
#include "mapping/snapshot.hpp"
#include "node/protocol_messages.hpp"

namespace scree::node {

/// What a heartbeat tells of the node.
struct NodeStatus {
  std::uint64_t frames_in = 0;
  std::uint64_t frames_dropped = 0;
  std::uint32_t latency_p50_us = 0;
  std::uint32_t latency_p99_us = 0;
  std::uint32_t latency_max_us = 0;
  std::uint16_t health = 0;               ///< bits of the common header (protocol::Health)
  std::uint32_t sensor_age_ms = 0;        ///< since the last frame
  std::optional<drivers::Origin> origin;  ///< set: of the frames, in place of what open() was told
};

struct PublisherCounters {
  std::uint64_t datagrams = 0;
  std::uint64_t bytes = 0;
  std::uint64_t send_errors = 0;           ///< refused by the kernel: too long, no route, not permitted
  std::uint64_t send_blocked = 0;          ///< times that the kernel's buffer was full; nothing is lost by it
  std::uint64_t blocks = 0;                ///< TILE datagrams
  std::uint64_t blocks_refreshed = 0;      ///< of these, unchanged since they were last sent
  std::uint64_t snapshots = 0;             ///< submitted
  std::uint64_t snapshots_superseded = 0;  ///< replaced before all of their changes were sent
  std::uint64_t snapshots_refused = 0;     ///< empty, more than kMaxWindowTiles, or another cell size than announced
  std::uint64_t cells_saturated = 0;       ///< values moved to the end of their layer's range, over all snapshots
};

class Publisher {
 public:
  /// Opens the socket. `config_hash`: protocol::config_hash of the canonical effective configuration.
  /// Errors: unavailable (address, port), usage (destination that cannot be parsed), bad_config (names).
  static Result<std::unique_ptr<Publisher>> open(const config::PublishSettings& settings, drivers::Origin origin,
                                                 double cell_m, std::uint32_t config_hash);
  ~Publisher();

  /// The newest map; what of older ones was not sent yet is superseded, no change is lost. The tiles are cut here: the
  /// snapshot is not held. Cost: about 45 ns per cell (measured: 1.8 ms for 200 × 200). Null is ignored.
  void submit(std::shared_ptr<const mapping::MapSnapshot> snapshot);

  /// Sends what is due within the pacing; returns how long until something is due again. Never blocks. `now` must not
  /// run backwards.
  Duration tick(MonotonicTime now, const NodeStatus& status);

  /// Sends the whole newest map (paced, with heartbeats between), its manifests, a last heartbeat and BYE three times.
  /// Takes as long as the pacing needs for the map's datagrams. Errors: io (for 2 s nothing could be sent), bad_config
  /// (`error()`).
  Status finish(const NodeStatus& status, protocol::ByeReason reason = protocol::ByeReason::finished);

  const PublisherCounters& counters() const;
  /// Set once a datagram was too long for the path to the destination; nothing useful is sent from then on.
  const std::optional<Error>& error() const;
  std::uint64_t boot_id() const;

 private:
  struct State;
  explicit Publisher(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace scree::node
