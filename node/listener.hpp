#pragma once
// A receiver of the map protocol: what `scree listen` shows and what the tests hold against the node.

#include <array>
#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <set>
#include <string>

#include "core/result.hpp"
#include "drivers/source.hpp"
#include "mapping/snapshot.hpp"
#include "node/protocol_messages.hpp"
#include "node/protocol_reject.hpp"
#include "node/protocol_requests.hpp"

namespace scree::node {

/// Every datagram is accepted or counted under exactly one reason:
/// datagrams == accepted + rejected + refused_origin + ignored.
struct ListenerCounters {
  std::uint64_t datagrams = 0;             ///< received
  std::uint64_t accepted = 0;              ///< passed every check
  std::uint64_t lost = 0;                  ///< gaps in seq that no late datagram filled, over all boots
  std::uint64_t rejected = 0;              ///< failed a check; sum of rejected_by without origin, type and layer
  std::uint64_t refused_origin = 0;        ///< replay, sim or hil where not accepted
  std::uint64_t ignored = 0;               ///< types and layers that this reader does not know
  std::uint64_t tiles = 0;                 ///< TILE blocks taken into the map
  std::uint64_t tiles_without_window = 0;  ///< accepted, but no ANNOUNCE yet
  std::uint64_t tiles_outside = 0;         ///< accepted, but outside the announced window
  std::uint64_t tiles_outdated = 0;        ///< accepted, but older than what is held
  std::uint64_t overflowed = 0;            ///< dropped by the kernel: receive buffer full
  std::array<std::uint64_t, protocol::kRejectReasons> rejected_by{};  ///< by protocol::Reject
};

/// What a listener hears, and of whom it asks it.
struct ListenerConfig {
  std::string address = "127.0.0.1:47800";  ///< port 0 = any free one; a multicast group is joined
  std::string multicast_interface;          ///< IPv4 address of the interface for a group; empty = the kernel's choice
  std::set<drivers::Origin> accept;
  std::optional<std::uint32_t> stream_id;  ///< none: the first one of an accepted origin that comes
  protocol::KeyRing keys;                  ///< with keys, what has no MAC of one of them is refused
  std::optional<std::string> node;         ///< subscribe there ("127.0.0.1:47801"); needs stream_id
  protocol::Subscribe wish;                ///< for this
};

struct ClientCounters;

enum class LinkState : std::uint8_t { waiting, fresh, stale, lost };

class Listener {
 public:
  /// Binds, joins, subscribes. Errors: unavailable (port taken), usage (not an address, every address at once, a node
  /// without a stream).
  static Result<std::unique_ptr<Listener>> open(const ListenerConfig& config);
  /// Hears `address` alone, without keys.
  static Result<std::unique_ptr<Listener>> open(const std::string& address, std::set<drivers::Origin> accept,
                                                std::optional<std::uint32_t> stream_id = std::nullopt);
  /// Ends the subscription, if there is one.
  ~Listener();

  /// Receives for at most `timeout`, then applies the freshness rules and asks the node for what is due. True when
  /// something arrived.
  Result<bool> poll(std::chrono::milliseconds timeout);

  std::uint16_t port() const;  ///< the one that is bound
  LinkState link() const;
  bool ended() const;  ///< BYE was received
  std::optional<protocol::ByeReason> bye_reason() const;
  std::optional<drivers::Origin> origin() const;          ///< of the last accepted datagram
  std::optional<drivers::Origin> refused_origin() const;  ///< of the last one that was refused for it
  std::uint16_t health() const;                           ///< FAULT also when two senders share the stream
  const ListenerCounters& counters() const;
  /// The last ANNOUNCE of the present boot: names, layers, geo anchor, times.
  const std::optional<protocol::Announce>& announce() const;
  const std::optional<protocol::Heartbeat>& heartbeat() const;
  /// Of the frame that was fused last.
  const std::optional<protocol::PoseMessage>& pose() const;
  /// What was asked of the node; none when it is not asked.
  const ClientCounters* client() const;

  /// The map as received now, on the cells that ANNOUNCE names; every cell unknown (and never_seen) unless the link is
  /// fresh or stale. Layers that were not received are NaN, hits 0, T_map_body the identity. Null before the first
  /// ANNOUNCE. Cost: a new snapshot each call, about 40 ns per cell.
  std::shared_ptr<const mapping::MapSnapshot> map() const;
  /// The last valid map: the present one while the link is fresh or stale, else as it was before it was LOST.
  std::shared_ptr<const mapping::MapSnapshot> last_valid_map() const;

  // from the last HEARTBEAT
  std::uint64_t frames_in() const;
  std::uint64_t frames_dropped() const;
  std::uint32_t latency_p50_us() const;
  std::uint32_t latency_p99_us() const;

 private:
  struct State;
  explicit Listener(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace scree::node
