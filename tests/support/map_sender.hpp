#pragma once
// A node in small: sends a made-up map by docs/protocol.md, answers SUBSCRIBE, NACK and PING. Every cell is a function
// of (seed, layer, tile, revision), so what a client shows can be held against what was sent.

#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <vector>

#include "node/protocol.hpp"
#include "node/protocol_requests.hpp"
#include "node/tile_window.hpp"
#include "tests/support/bad_network.hpp"

namespace scree::test {

struct MapSenderSettings {
  std::uint64_t seed = 1;
  std::uint64_t boot_id = 0x5EED;
  LatticeWindow window{{-70, 13}, 200, 200};
  std::vector<node::protocol::Layer> layers{node::protocol::Layer::cost, node::protocol::Layer::elevation,
                                            node::protocol::Layer::cell_state};
  double changing = 0.3;  ///< share of the tiles that a revision changes
  double revisions_per_s = 10.0;
  double datagrams_per_s = 3000.0;
  double refresh_s = 1.0;
  std::optional<node::protocol::Key> key;
  bool needs_subscription = false;
};

/// A change of one layer of one tile.
struct Change {
  node::protocol::Layer layer;
  node::TileIndex tile;
  std::uint32_t rev;
};

class MapSender {
 public:
  using Send = std::function<void(std::span<const std::uint8_t>)>;
  explicit MapSender(const MapSenderSettings& settings);

  /// What is due at `now`. Times must not run backwards.
  void tick(Nanoseconds now, const Send& send);
  /// A request of a client.
  void receive(std::span<const std::uint8_t> datagram, Nanoseconds now, const Send& send);
  void say_bye(const Send& send);

  /// The changes of the newest revision, and when it was made.
  const std::vector<Change>& changes() const { return changes_; }
  Nanoseconds changed_at() const { return changed_at_; }
  std::uint32_t revision() const { return revision_; }
  const std::vector<std::uint32_t>& revisions_of(node::TileIndex tile) const { return history_[tiles_.position(tile)]; }
  const MapSenderSettings& settings() const { return settings_; }
  const node::TileWindow& tiles() const { return tiles_; }
  std::uint64_t nacks_received() const { return nacks_; }

  /// The block that was, is or will be sent of this revision; half 1 is the upper one of a 16-bit layer.
  static node::protocol::TileBlock content(std::uint64_t seed, node::protocol::Layer layer, node::TileIndex tile,
                                           std::uint32_t rev, int half);

 private:
  struct Unit {
    std::uint32_t rev = 0;
    Nanoseconds sent{0};
    bool pending = false;
    bool nacked = false;
  };
  struct Copy {
    Nanoseconds due;
    std::size_t unit;
    std::uint32_t rev;
  };
  node::protocol::Header header(Nanoseconds now);
  template <class Message>
  void emit(const Message& message, Nanoseconds now, const Send& send) {
    node::protocol::Datagram datagram;
    encode(header(now), message, datagram, keys_.signer());
    send(datagram.view());
  }
  void revise(Nanoseconds now);
  void send_unit(std::size_t unit, Nanoseconds now, const Send& send);
  void send_tiles(Nanoseconds now, const Send& send);
  void send_manifests(Nanoseconds now, const Send& send);
  void send_announce(Nanoseconds now, const Send& send);
  bool subscribed(Nanoseconds now) const { return !settings_.needs_subscription || now < lease_end_; }

  MapSenderSettings settings_;
  node::TileWindow tiles_;
  node::protocol::KeyRing keys_;
  std::uint64_t seq_ = 0;
  std::uint32_t revision_ = 0;
  std::vector<Unit> units_;  // by layer, then tile
  std::vector<std::vector<std::uint32_t>> history_;
  std::vector<Change> changes_;
  std::deque<std::size_t> pending_, nacked_;
  std::deque<Copy> copies_;
  Nanoseconds changed_at_{0}, next_revision_{0}, next_heartbeat_{0}, next_announce_{0}, next_manifest_{0},
      next_refresh_{0};
  Nanoseconds last_tick_{0}, lease_end_{0};
  bool manifest_wanted_ = false;
  double tokens_ = 0.0;
  int repeats_ = 0;
  std::uint64_t nacks_ = 0;
};

}  // namespace scree::test
