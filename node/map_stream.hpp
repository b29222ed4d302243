#pragma once
// One destination of the map: what it wants, what it got, and when it gets what.

#include <functional>
#include <memory>
#include <optional>

#include "node/protocol.hpp"
#include "node/published_map.hpp"
#include "node/publisher_outbox.hpp"
#include "node/publisher_pacing.hpp"
#include "node/send_queue.hpp"

namespace scree::node {

inline constexpr Duration kHeartbeatPeriod = std::chrono::milliseconds(100);
inline constexpr Duration kAnnouncePeriod = std::chrono::seconds(1);
/// A receiver that misses where the window moved to takes no tile of it until it hears: for so long one loss must not
/// decide.
inline constexpr int kAnnounceCopies = 2;
inline constexpr Duration kAnnounceCopyPeriod = std::chrono::milliseconds(100);
inline constexpr Duration kManifestPeriod = std::chrono::milliseconds(100);
inline constexpr double kManifestShare = 0.25;  ///< of the pacing, at most
/// Between the copies of a block: longer than most bursts of loss.
inline constexpr Duration kRepeatDistance = std::chrono::milliseconds(20);

/// What a destination wants.
struct StreamWish {
  std::uint64_t layer_mask = ~std::uint64_t{0};
  protocol::TileRegion region;
  double datagrams_per_s = 3000;
  int repeats = 0;  ///< extra copies of every changed block
};

class MapStream {
 public:
  /// To `to` by a socket that others may use too, or where `socket` is connected to. Nothing is sent yet.
  MapStream(std::shared_ptr<UdpSocket> socket, std::optional<Endpoint> to, const StreamWish& wish,
            std::uint64_t first_seq, const PublishedMap& map);

  /// Units that are wanted from now on are pending, those no longer wanted are forgotten.
  void change(const StreamWish& wish, const PublishedMap& map);
  /// Once after each map.take(): what of it there is to send.
  void note_map(const PublishedMap& map, bool window_moved);
  /// A client misses it: sent again ahead of refreshes. False: not one of its units, or it waits already.
  bool resend(UnitHandle unit, const PublishedMap& map);

  /// Sends what is due within the pacing; until something is due again. Never blocks.
  Duration tick(MonotonicTime now, PublishedMap& map);
  /// One message out of turn; it may overdraw the pacing. False: no room, nothing was sent.
  template <class Message>
  bool answer(const Message& message, MonotonicTime now, PublishedMap& map) {
    if (!make_room(1, map)) return false;
    add(map.header(now), message, map);
    return outbox_.flush(map.counters), true;
  }

  const SendQueue& queue() const { return queue_; }
  const Outbox& outbox() const { return outbox_; }
  /// Changed blocks of maps up to and with this generation have left; those of later ones have not all.
  std::uint64_t generation_out(const PublishedMap& map) const;

  /// Everything is to be sent once more.
  void send_all_again(const PublishedMap& map);

  // of the end (publisher_finish.cpp)
  /// Pending blocks, heartbeats and announcements within the pacing; no refreshes, no manifests.
  void send_pending(MonotonicTime now, PublishedMap& map);
  Duration until_worthwhile() const { return bucket_.until_worthwhile(); }
  /// Asks `room` before each datagram; false when there was none: the manifests are still to be sent.
  bool send_manifests(MonotonicTime now, PublishedMap& map, const std::function<bool()>& room);
  void send_heartbeat(MonotonicTime now, PublishedMap& map);
  void send_bye(MonotonicTime now, PublishedMap& map, protocol::ByeReason reason, int copy);
  bool make_room(std::size_t datagrams, PublishedMap& map) {
    return outbox_.room() >= datagrams || (outbox_.flush(map.counters) && outbox_.room() >= datagrams);
  }
  bool flush(PublishedMap& map) { return outbox_.flush(map.counters); }

 private:
  template <class Message>
  void add(const protocol::Header& header, const Message& message, PublishedMap& map) {
    outbox_.add(header, message, map.keys.signer());
    bucket_.take(1);
  }
  bool wants(const TileUnit& unit) const {
    return (wish_.layer_mask & layer_bit(unit.layer)) != 0 && wish_.region.contains(unit.tile);
  }
  void select_units(const PublishedMap& map);
  void send_announce(MonotonicTime now, PublishedMap& map);
  void send_periodic(MonotonicTime now, PublishedMap& map);  ///< heartbeat and announcement, when due
  void send_poses(MonotonicTime now, PublishedMap& map);
  void send_tiles(MonotonicTime now, PublishedMap& map);
  void send_unit(MonotonicTime now, PublishedMap& map, UnitHandle handle, std::uint8_t flags);
  bool send_repeat(MonotonicTime now, PublishedMap& map);
  TileWindow wanted_window(const PublishedMap& map) const;
  Duration until_due(MonotonicTime now, const PublishedMap& map) const;
  /// As soon as all of a revision is out, and every 100 ms whatever is still waiting; both only as often as leaves
  /// three quarters of the pacing to others.
  MonotonicTime manifest_due() const {
    return manifest_wanted_ && !queue_.has_pending() ? earliest_manifest_ : next_manifest_;
  }
  Duration refresh_interval(const PublishedMap& map) const;
  std::uint32_t refresh_ms(const PublishedMap& map) const;

  StreamWish wish_;
  Outbox outbox_;
  TokenBucket bucket_;
  SendQueue queue_;
  std::uint64_t next_pose_;
  MonotonicTime next_heartbeat_;  // the epoch: due at once
  MonotonicTime next_announce_;
  MonotonicTime earliest_manifest_;  // by their share of the pacing
  MonotonicTime next_manifest_;
  MonotonicTime next_refresh_;
  bool announced_window_ = false;  // the window is the one last announced
  int announce_copies_ = 0;        // still to be sent of a window that is new
  bool manifest_wanted_ = false;   // a new revision is waiting for its manifest
  bool refresh_turn_ = false;      // changed and refreshed units take turns when both are due
};

}  // namespace scree::node
