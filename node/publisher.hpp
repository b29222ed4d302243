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

namespace scree::node {

/// What a heartbeat tells of the node.
struct NodeStatus {
  std::uint64_t frames_in = 0;
  std::uint64_t frames_dropped = 0;
  std::uint32_t latency_p50_us = 0;
  std::uint32_t latency_p99_us = 0;
  std::uint32_t latency_max_us = 0;
  std::uint16_t health = 0;         ///< bits of the common header
  std::uint32_t sensor_age_ms = 0;  ///< since the last frame
};

struct PublisherCounters {
  std::uint64_t datagrams = 0;
  std::uint64_t bytes = 0;
  std::uint64_t send_errors = 0;
};

class Publisher {
 public:
  /// Opens the socket. `config_hash`: first 4 bytes of BLAKE2b of the canonical effective configuration.
  /// Errors: unavailable (address, port), usage (destination that cannot be parsed).
  static Result<std::unique_ptr<Publisher>> open(const config::PublishSettings& settings, drivers::Origin origin,
                                                 double cell_m, std::uint32_t config_hash);
  ~Publisher();

  /// The newest map; older ones that were not sent yet are superseded.
  void submit(std::shared_ptr<const mapping::MapSnapshot> snapshot);

  /// Sends what is due within the pacing; returns how long until something is due again.
  Duration tick(MonotonicTime now, const NodeStatus& status);

  /// Sends the rest of the newest map (paced), its manifests, a last heartbeat and BYE three times.
  Status finish(const NodeStatus& status);

  const PublisherCounters& counters() const;

 private:
  struct State;
  explicit Publisher(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace scree::node
