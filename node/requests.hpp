#pragma once
// What clients ask of the node: checked by the thread that receives, waiting for the one that publishes.

#include <array>
#include <cstdint>
#include <mutex>
#include <span>
#include <variant>
#include <vector>

#include "core/time.hpp"
#include "node/protocol.hpp"
#include "node/udp_socket.hpp"

namespace scree::node {

struct Request {
  Endpoint from;
  std::uint64_t boot_id = 0;  ///< the client's
  std::uint64_t seq = 0;
  MonotonicTime arrived;
  Time arrived_at;  ///< on the system clock
  std::variant<protocol::Subscribe, protocol::Nack, protocol::Ping> message;
};

/// datagrams == accepted + rejected.
struct RequestCounters {
  std::uint64_t datagrams = 0;
  std::uint64_t accepted = 0;
  std::uint64_t rejected = 0;  ///< sum of rejected_by
  std::array<std::uint64_t, protocol::kRejectReasons> rejected_by{};
};

/// The checks that need no memory of the client.
class RequestReader {
 public:
  /// With `keys`, datagrams without the MAC of one of them are refused.
  RequestReader(std::uint32_t stream_id, const protocol::KeyRing& keys) : stream_id_(stream_id), keys_(keys) {}

  /// In order: the datagram's own checks, stream, type, body. Fills from, boot_id, seq and message of `out`. Counts.
  protocol::Reject read(std::span<const std::uint8_t> datagram, const Endpoint& from, Request& out);
  const RequestCounters& counters() const { return counters_; }

 private:
  protocol::Reject judge(std::span<const std::uint8_t> datagram, Request& out) const;

  std::uint32_t stream_id_;
  protocol::KeyRing keys_;
  RequestCounters counters_;
};

/// A bounded queue between two threads; what finds it full is counted and gone, as UDP may lose it anyway.
class RequestQueue {
 public:
  static constexpr std::size_t kCapacity = 256;

  RequestQueue() : ring_(kCapacity) {}
  void push(const Request& request);
  /// False when there is none.
  bool pop(Request& out);
  bool empty() const;
  std::uint64_t overflowed() const;

 private:
  mutable std::mutex mutex_;
  std::vector<Request> ring_;
  std::size_t first_ = 0;
  std::size_t size_ = 0;
  std::uint64_t overflowed_ = 0;
};

}  // namespace scree::node
