#pragma once
// Poses from another process: POSE_INPUT datagrams. One thread receives them, another one takes them.

#include <array>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <optional>
#include <span>
#include <stop_token>

#include "core/pose.hpp"
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
  std::uint64_t in_past = 0;          ///< the pose's time is more than 10 s ago: a recorded session, or a wrong clock
  std::array<std::uint64_t, protocol::kRejectReasons> rejected_by{};  ///< by protocol::Reject
};

/// The checks and the history, without the socket.
class PoseReceiver {
 public:
  /// With `keys`, datagrams without the MAC of one of them are refused.
  PoseReceiver(const Endpoint& accept_from, std::uint32_t stream_id, const protocol::KeyRing& keys = {})
      : accept_from_(accept_from), stream_id_(stream_id), keys_(keys) {}

  /// True when the pose was taken. `now` is the node's system clock. In order: address, the datagram's own checks with
  /// its MAC, stream, type and body, boot_id (a new one forgets the history, an earlier one is refused), seq (only
  /// upwards within a boot), time: at most 1 s ahead of `now` and 10 s behind it, and only upwards, over restarts of
  /// the source too. So what was recorded of an earlier session is refused, whichever boot_id it has. Only a pose that
  /// passed all of them changes anything but the counters.
  bool accept(std::span<const std::uint8_t> datagram, const Endpoint& from, Time now, MonotonicTime delivered = {});

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
  std::optional<Time> newest_;  ///< of all boots
  PoseInputCounters counters_;
};

/// A receiver that two threads share.
class PoseInput {
 public:
  explicit PoseInput(PoseReceiver receiver) : receiver_(std::move(receiver)) {}

  /// See PoseReceiver::accept; wakes who waits.
  bool accept(std::span<const std::uint8_t> datagram, const Endpoint& from, Time now, MonotonicTime delivered);

  /// Interpolated; nothing before the oldest kept pose or after the newest one. O(log n).
  std::optional<UncertainPose> at(Time time) const;
  std::optional<UncertainPose> newest() const;
  /// Until a pose at or after `time` is there; false after `timeout` or on `stop`.
  bool wait_for(Time time, std::chrono::milliseconds timeout, const std::stop_token& stop);
  PoseInputCounters counters() const;

 private:
  mutable std::mutex mutex_;
  std::condition_variable_any changed_;
  PoseReceiver receiver_;
};

}  // namespace scree::node
