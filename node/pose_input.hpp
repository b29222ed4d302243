#pragma once
// Poses from another process: POSE_INPUT datagrams on publish.listen. Used by one thread.

#include <array>
#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "core/pose.hpp"
#include "core/result.hpp"
#include "core/time.hpp"
#include "drivers/frame/pose_track.hpp"
#include "node/pose_history.hpp"
#include "node/protocol.hpp"
#include "node/udp_socket.hpp"

namespace scree::node {

/// datagrams == accepted + rejected.
struct PoseInputCounters {
  std::uint64_t datagrams = 0;
  std::uint64_t accepted = 0;
  std::uint64_t rejected = 0;         ///< all of the following
  std::uint64_t foreign_address = 0;  ///< not from the accepted address
  std::uint64_t not_later = 0;        ///< the pose's time is not after the last one
  std::uint64_t in_future = 0;        ///< the pose's time is beyond the node's clock by more than 1 s
  std::array<std::uint64_t, protocol::kRejectReasons> rejected_by{};  ///< by protocol::Reject
};

/// The checks and the history, without the socket.
class PoseReceiver {
 public:
  /// With `keys`, datagrams without the MAC of one of them are refused.
  PoseReceiver(const Endpoint& accept_from, std::uint32_t stream_id, const protocol::KeyRing& keys = {})
      : accept_from_(accept_from), stream_id_(stream_id), keys_(keys) {}

  /// True when the pose was taken. `now` is the node's system clock. In order: address, the datagram's own checks,
  /// stream, type and body, boot_id (a new one forgets the history, an earlier one is refused), seq (only upwards),
  /// time (only upwards, at most 1 s ahead of `now`). Only a pose that passed all of them changes anything but the
  /// counters.
  bool accept(std::span<const std::uint8_t> datagram, const Endpoint& from, Time now);

  const PoseHistory& history() const { return history_; }
  const PoseInputCounters& counters() const { return counters_; }

 private:
  protocol::Reject judge(std::span<const std::uint8_t> datagram, protocol::Opened& opened,
                         protocol::PoseInputMessage& message) const;
  protocol::Reject check_sequence(const protocol::Header& header) const;
  void begin_history(std::uint64_t boot_id);

  Endpoint accept_from_;
  std::uint32_t stream_id_;
  protocol::KeyRing keys_;
  std::optional<std::uint64_t> boot_id_;
  std::uint64_t seq_ = 0;
  std::array<std::uint64_t, 8> old_boots_{};  ///< 0 = none
  std::size_t boots_ = 0;
  PoseHistory history_;
  PoseInputCounters counters_;
};

class PoseInput {
 public:
  /// Binds `listen` ("127.0.0.1:47801"; port 0 = any free one). Poses are taken from the address `accept_from` alone
  /// (any port of it); empty = the loopback address of `listen`'s family. Errors: unavailable (port taken), usage (not
  /// an address).
  static Result<std::unique_ptr<PoseInput>> open(const std::string& listen, const std::string& accept_from,
                                                 std::uint32_t stream_id);

  /// Receives for at most `timeout`; true when a pose was taken. Errors: io.
  Result<bool> poll(std::chrono::milliseconds timeout);

  std::uint16_t port() const { return socket_.local_port(); }
  /// Interpolated; nothing before the oldest kept pose or after the newest one. O(log n).
  std::optional<UncertainPose> at(Time time) const { return receiver_.history().at(time); }
  std::optional<UncertainPose> newest() const { return receiver_.history().newest(); }
  const PoseInputCounters& counters() const { return receiver_.counters(); }

 private:
  PoseInput(UdpSocket socket, PoseReceiver receiver) : socket_(std::move(socket)), receiver_(std::move(receiver)) {}

  UdpSocket socket_;
  PoseReceiver receiver_;
};

}  // namespace scree::node
