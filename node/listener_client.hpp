#pragma once
// A receiver that asks: subscribes at a node, asks again for what it misses, measures the way there. No socket and no
// clock of its own.

#include <cstdint>
#include <functional>
#include <optional>
#include <span>

#include "node/listener_assembly.hpp"
#include "node/protocol.hpp"

namespace scree::node {

struct ClientCounters {
  std::uint64_t subscribes = 0;  ///< SUBSCRIBE sent
  std::uint64_t nacks = 0;       ///< NACK sent
  std::uint64_t nack_tiles = 0;  ///< tiles that they named
  std::uint64_t pings = 0;
  std::uint64_t pongs = 0;  ///< answers to these
  std::optional<Duration> round_trip;
  std::optional<Duration> clock_offset;  ///< of the node's system clock to this one's, within half the round trip
};

class NodeClient {
 public:
  static constexpr Duration kPeriod = std::chrono::seconds(1);            ///< of SUBSCRIBE and PING
  static constexpr Duration kNackPeriod = std::chrono::milliseconds(20);  ///< of looking for what is missing
  using Send = std::function<void(std::span<const std::uint8_t>)>;

  /// Asks for `wish` (its cookie is not looked at) of `stream_id`; `boot_id`: random. Signs with the first of `keys`.
  NodeClient(const protocol::Subscribe& wish, std::uint32_t stream_id, std::uint64_t boot_id,
             const protocol::KeyRing& keys)
      : wish_(wish), stream_id_(stream_id), boot_id_(boot_id), keys_(keys) {}

  /// Sends what is due: SUBSCRIBE every second and at once with a new cookie, PING every second, NACK for tiles that a
  /// MANIFEST named 50 ms ago and that did not come, for each again after 100 ms.
  void tick(MonotonicTime now, Time system_now, MapAssembly& assembly, const Send& send);
  /// Ends the subscription.
  void end(const Send& send);

  const ClientCounters& counters() const { return counters_; }

 private:
  template <class Message>
  void send_message(const Message& message, const Send& send);
  void subscribe(const Send& send);
  void ping(MonotonicTime now, Time system_now, const Send& send);
  void take_pong(const MapAssembly& assembly);

  protocol::Subscribe wish_;
  std::uint32_t stream_id_;
  std::uint64_t boot_id_;
  protocol::KeyRing keys_;
  std::uint64_t seq_ = 0;
  MonotonicTime next_subscribe_;  // the epoch: at once
  MonotonicTime next_ping_;
  MonotonicTime next_nack_;
  MonotonicTime ping_sent_;
  std::uint64_t nonce_ = 0;
  bool ping_open_ = false;
  ClientCounters counters_;
};

}  // namespace scree::node
