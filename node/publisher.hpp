#pragma once
// Sends the map as datagrams: announce, tiles on change and by cyclic refresh, manifests, poses, heartbeats, BYE; to
// the configured destination and to those who subscribe. Single-threaded: the publish thread owns it.

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "config/settings.hpp"
#include "core/result.hpp"
#include "mapping/snapshot.hpp"
#include "node/protocol_messages.hpp"
#include "node/published_map.hpp"
#include "node/requests.hpp"
#include "node/subscriptions.hpp"
#include "node/udp_socket.hpp"

namespace scree::node {

class Publisher {
 public:
  /// Opens the socket. `config_hash`: protocol::config_hash of the canonical effective configuration. `clients`: by it
  /// requests are answered and subscribers get the map; without it there are none.
  /// Errors: unavailable (address, port), usage (destination that cannot be parsed), bad_config (names, keys).
  static Result<std::unique_ptr<Publisher>> open(const config::PublishSettings& settings, drivers::Origin origin,
                                                 double cell_m, std::uint32_t config_hash,
                                                 std::shared_ptr<UdpSocket> clients = nullptr);
  ~Publisher();

  /// The newest map; what of older ones was not sent yet is superseded, no change is lost. The tiles are cut here: the
  /// snapshot is not held. Latency counts from `taken` (none: from when the data was received). Cost: docs/protocol.md,
  /// "Cost". Null is ignored.
  void submit(const std::shared_ptr<const mapping::MapSnapshot>& snapshot,
              std::optional<MonotonicTime> taken = std::nullopt);

  /// The pose that a frame was fused with, and when the node got it. Sent once to every destination.
  void add_pose(const protocol::PoseMessage& pose, MonotonicTime delivered);

  /// What a client asked. Its answer, if any, leaves at once; tiles leave with the ticks.
  void handle(const Request& request, MonotonicTime now);

  /// Sends what is due within the pacing; returns how long until something is due again. Never blocks. `now` must not
  /// run backwards.
  Duration tick(MonotonicTime now, const NodeStatus& status);

  /// Sends the whole newest map (paced, with heartbeats between), its manifests, a last heartbeat and BYE three times.
  /// Takes as long as the pacing needs for the map's datagrams at the configured destination, and at most 2 s longer
  /// for subscribers, whose troubles are no error. `between` is called every few milliseconds: it may call handle.
  /// Errors: io (for 2 s nothing could be sent), bad_config (`error()`).
  Status finish(const NodeStatus& status, protocol::ByeReason reason = protocol::ByeReason::finished,
                const std::function<void()>& between = {});

  const PublisherCounters& counters() const;
  const SubscriptionCounters& subscriptions() const;
  std::size_t subscribers() const;  ///< now, without the configured destination
  /// Frame in to the last changed block of its map out, at the configured destination.
  const LatencyHistogram& latency() const;
  /// Set once a datagram was too long for the path to the destination; nothing useful is sent from then on.
  const std::optional<Error>& error() const;
  std::uint64_t boot_id() const;

 private:
  struct State;
  explicit Publisher(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// The ring of the keys that the configuration names. Errors: bad_config (more than two, an id twice or 0).
Result<protocol::KeyRing> make_key_ring(const std::vector<config::KeySettings>& keys);

}  // namespace scree::node
