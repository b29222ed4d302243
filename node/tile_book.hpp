#pragma once
// What there is to send: the quantised tiles of the newest map, which of them changed, and which were not sent for
// the longest time.

#include <array>
#include <list>
#include <vector>

#include "core/time.hpp"
#include "mapping/snapshot.hpp"
#include "node/protocol_layers.hpp"
#include "node/tile_quantise.hpp"
#include "node/tile_window.hpp"

namespace scree::node {

/// The layers that are published, in the order of sending.
inline constexpr std::array kPublishedLayers = {protocol::Layer::cost,       protocol::Layer::elevation,
                                                protocol::Layer::cell_state, protocol::Layer::dimension,
                                                protocol::Layer::amplitude,  protocol::Layer::cell_age};

/// Ages grow in every map. A tile's are taken anew when other cells of it are known than before, or after this time on
/// the clock of the data: about when they would be refreshed anyway.
inline constexpr Duration kAgePeriod = std::chrono::seconds(1);

/// One layer of one tile.
struct TileUnit {
  TileIndex tile;
  protocol::Layer layer = protocol::Layer::cost;
  std::uint32_t tile_rev = 0;  ///< map revision at which this layer of this tile last changed
  bool filled = false;         ///< has content
  bool pending = false;        ///< waits to be sent
  bool changed = false;        ///< differs from what was last sent
  Time taken;                  ///< of the data of `content`
  QuantisedTile content;
};

class TileBook {
 public:
  /// Cuts the snapshot into tiles. A unit whose quantised content changed, or that is new in the window, gets the
  /// snapshot's revision and becomes pending; one that is pending already keeps its place. Tiles that left the window
  /// are forgotten. Cost: about 9 ns per cell and layer.
  void update(const mapping::MapSnapshot& snapshot);

  bool has_pending() const { return !pending_.empty(); }
  /// The unit that waits longest, or the one that was sent longest ago. Null when there is none. Valid until update.
  TileUnit* next_pending() { return pending_.empty() ? nullptr : &pending_.front(); }
  TileUnit* least_recently_sent() { return sent_.empty() ? nullptr : &sent_.front(); }
  /// The unit (one of the two above) was handed to the socket.
  void mark_sent(TileUnit& unit);
  /// Everything is to be sent once more.
  void mark_all_pending();

  /// Datagrams of the units that are pending. Walks them.
  std::size_t pending_blocks() const;

  const TileWindow& window() const { return window_; }
  std::size_t units() const { return index_.size() * kPublishedLayers.size(); }
  /// Of one datagram each; a 16-bit layer takes two.
  std::size_t blocks() const;
  std::uint32_t tile_rev(std::size_t position, std::size_t layer) const { return index_[position][layer]->tile_rev; }
  /// Tiles with at least one known cost.
  std::uint32_t tiles_known() const { return tiles_known_; }
  const QuantisationCounts& quantisation() const { return quantisation_; }

 private:
  using Units = std::list<TileUnit>;  // nodes keep their address while they change lists
  using Slot = std::array<Units::iterator, kPublishedLayers.size()>;

  void move_window(const TileWindow& window);
  void refresh_unit(const mapping::MapSnapshot& snapshot, Units::iterator unit);

  TileWindow window_;
  std::vector<Slot> index_;  // by position in the window
  Units pending_;            // first = waits longest
  Units sent_;               // first = sent longest ago
  std::uint32_t tiles_known_ = 0;
  QuantisationCounts quantisation_;
  std::array<float, protocol::kTileArea> values_{};
  QuantisedTile scratch_;
};

}  // namespace scree::node
