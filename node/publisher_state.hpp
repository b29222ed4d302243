#pragma once
// The publisher's insides: one map, its destinations, its subscriptions.

#include <memory>
#include <optional>
#include <vector>

#include "node/map_stream.hpp"
#include "node/publisher.hpp"

namespace scree::node {

struct Publisher::State {
  State(PublishedMap published, std::shared_ptr<UdpSocket> fixed, const Endpoint& destination, const CookieJar& cookies,
        std::shared_ptr<UdpSocket> to_clients);

  MapStream& fixed() { return *streams[0]; }
  Duration tick(MonotonicTime now, const NodeStatus& status);
  void expire_leases(MonotonicTime now);
  void measure_latency(MonotonicTime now);

  // requests (publisher_requests.cpp)
  StreamWish wish_of(const protocol::Subscribe& subscribe) const;
  void begin_stream(std::size_t slot);
  void change_stream(std::size_t slot);
  void end_stream(std::size_t slot);
  void resend(std::size_t slot, const protocol::Nack& nack);
  /// By the client's stream if it has one: then it has its place in that sequence.
  template <class Message>
  void answer(const Endpoint& to, const Message& message, MonotonicTime now);

  // of the end (publisher_finish.cpp); they sleep
  bool wait_for_room(std::size_t datagrams);  ///< at the fixed destination; false: the kernel took nothing for 2 s
  bool send_pending(const std::function<void()>& between);  ///< false: no block could be sent for 2 s
  void send_last_manifests(bool& sent);
  bool send_farewell(protocol::ByeReason reason, bool patient);

  PublishedMap map;
  Subscriptions subscriptions;
  std::shared_ptr<UdpSocket> clients;             ///< may be null
  std::vector<std::optional<MapStream>> streams;  ///< by slot; 0 is the configured destination and always there
  /// Streams begin behind the last datagram of any that ended: a client that comes back never sees seq run backwards.
  std::uint64_t first_seq = 1;

  struct Submitted {
    std::uint64_t generation = 0;
    MonotonicTime taken;
  };
  std::vector<Submitted> under_way;  ///< maps whose blocks are not all out, oldest first
};

}  // namespace scree::node
