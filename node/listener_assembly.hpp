#pragma once
// A receiver without its socket: bytes and a clock in, a map and its freshness out.

#include <array>
#include <optional>
#include <set>
#include <span>

#include "node/listener.hpp"
#include "node/listener_tiles.hpp"
#include "node/protocol.hpp"

namespace scree::node {

class MapAssembly {
 public:
  /// With `keys`, datagrams without the MAC of one of them are refused.
  explicit MapAssembly(std::set<drivers::Origin> accept, std::optional<std::uint32_t> stream_id = std::nullopt,
                       const protocol::KeyRing& keys = {})
      : accept_(std::move(accept)), stream_id_(stream_id), keys_(keys) {}

  /// Checks one datagram and takes what it says. Returns the reason why not. `now` must not run backwards. A datagram
  /// that is not accepted changes nothing but counters, except that one of an earlier boot_id can raise FAULT.
  protocol::Reject accept(std::span<const std::uint8_t> datagram, MonotonicTime now);

  /// Applies the rules that depend on time alone.
  void advance(MonotonicTime now);

  std::shared_ptr<const mapping::MapSnapshot> map(MonotonicTime now) const;
  std::shared_ptr<const mapping::MapSnapshot> last_valid_map(MonotonicTime now) const;

  LinkState link() const { return link_; }
  bool ended() const { return bye_.has_value(); }
  std::optional<protocol::ByeReason> bye_reason() const { return bye_; }
  std::optional<drivers::Origin> origin() const { return origin_; }
  std::optional<drivers::Origin> refused_origin() const { return refused_origin_; }
  std::uint16_t health() const;
  const ListenerCounters& counters() const { return counters_; }
  const std::optional<protocol::Announce>& announce() const { return announce_; }
  const std::optional<protocol::Heartbeat>& heartbeat() const { return heartbeat_; }
  /// The cookie that the present boot gave last.
  std::optional<std::uint64_t> cookie() const { return cookie_; }
  struct ArrivedPong {
    protocol::Pong message;
    MonotonicTime arrived;
  };
  const std::optional<ArrivedPong>& pong() const { return pong_; }
  /// The pose of the frame that was fused last.
  const std::optional<protocol::PoseMessage>& pose() const { return pose_; }
  /// See TileStore::take_missing.
  bool take_missing(MonotonicTime now, protocol::Nack& nack) { return tiles_.take_missing(now, nack); }
  void set_overflowed(std::uint64_t datagrams) { counters_.overflowed = datagrams; }

 private:
  struct OldBoot {
    std::uint64_t boot_id = 0;
    MonotonicTime replaced;
  };

  protocol::Reject judge(std::span<const std::uint8_t> datagram, MonotonicTime now);
  protocol::Reject check_sender(const protocol::Opened& opened, MonotonicTime now);
  protocol::Reject take(const protocol::Opened& opened, MonotonicTime now);
  protocol::Reject take_announce(const protocol::Opened& opened);
  protocol::Reject take_tile(const protocol::Opened& opened, MonotonicTime now);
  protocol::Reject take_manifest(const protocol::Opened& opened, MonotonicTime now);
  protocol::Reject take_heartbeat(const protocol::Opened& opened, MonotonicTime now);
  protocol::Reject take_bye(const protocol::Opened& opened);
  protocol::Reject take_pose(const protocol::Opened& opened);
  protocol::Reject take_cookie(const protocol::Opened& opened);
  protocol::Reject take_pong(const protocol::Opened& opened, MonotonicTime now);
  void take_header(const protocol::Header& header, MonotonicTime now);
  void begin_boot(std::uint64_t boot_id, MonotonicTime now);
  void count(protocol::Reject reason);
  bool valid() const { return link_ == LinkState::fresh || link_ == LinkState::stale; }
  LinkState link_at(MonotonicTime now) const;
  std::shared_ptr<const mapping::MapSnapshot> make_map(MonotonicTime now, bool valid) const;

  std::set<drivers::Origin> accept_;
  std::optional<std::uint32_t> stream_id_;
  protocol::KeyRing keys_;

  // of the present boot
  std::optional<std::uint64_t> boot_id_;
  protocol::SequenceWindow sequence_;
  std::optional<protocol::Announce> announce_;
  std::uint64_t announce_seq_ = 0;
  std::optional<protocol::Heartbeat> heartbeat_;
  std::uint64_t heartbeat_seq_ = 0;
  MonotonicTime heartbeat_at_;
  std::optional<protocol::ByeReason> bye_;
  std::optional<std::uint64_t> cookie_;
  std::optional<ArrivedPong> pong_;
  std::optional<protocol::PoseMessage> pose_;
  std::uint64_t pose_seq_ = 0;
  protocol::Header newest_;  ///< header with the highest seq
  MonotonicTime acquired_;   ///< of its data, on this clock
  TileStore tiles_;

  std::array<OldBoot, 8> old_boots_{};
  std::size_t boots_ = 0;
  std::uint64_t lost_before_ = 0;  ///< in earlier boots
  std::optional<MonotonicTime> conflict_at_;
  LinkState link_ = LinkState::waiting;
  bool silent_ = false;  ///< no heartbeat for so long that the tiles were forgotten
  std::shared_ptr<const mapping::MapSnapshot> last_valid_;
  std::optional<drivers::Origin> origin_;
  std::optional<drivers::Origin> refused_origin_;
  ListenerCounters counters_;
  protocol::TileBlock block_;  ///< scratch
};

}  // namespace scree::node
