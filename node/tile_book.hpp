#pragma once
// The quantised tiles of the newest map, and which of them changed. Every destination sends from the same book.

#include <array>
#include <cstdint>
#include <optional>
#include <span>
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
  Time taken;                  ///< of the data of `content`
  QuantisedTile content;
};

/// Names a unit as long as its tile is in the window; then it is given to another one.
using UnitHandle = std::uint32_t;

class TileBook {
 public:
  /// Cuts the snapshot into tiles. A unit whose quantised content changed, or that is new in the window, gets the
  /// snapshot's revision. Tiles that left the window are forgotten. Cost: see docs/protocol.md, "Cost".
  void update(const mapping::MapSnapshot& snapshot);

  /// Of the last update: units whose tile left the window. Their handles may be among `changed`, for other tiles.
  std::span<const UnitHandle> removed() const { return removed_; }
  /// Of the last update, layer by layer: under congestion every tile's cost goes before any tile's amplitude.
  std::span<const UnitHandle> changed() const { return changed_; }

  const TileUnit& unit(UnitHandle handle) const { return units_[handle]; }
  /// All handles are below.
  std::size_t handles() const { return units_.size(); }
  UnitHandle at(std::size_t position, std::size_t layer) const {
    return slots_[position] * static_cast<UnitHandle>(kPublishedLayers.size()) + static_cast<UnitHandle>(layer);
  }
  /// None outside the window and for layers that are not published.
  std::optional<UnitHandle> find(TileIndex tile, protocol::Layer layer) const;

  const TileWindow& window() const { return window_; }
  std::uint32_t tile_rev(std::size_t position, std::size_t layer) const { return unit(at(position, layer)).tile_rev; }
  /// Tiles with at least one known cost.
  std::uint32_t tiles_known() const { return tiles_known_; }
  const QuantisationCounts& quantisation() const { return quantisation_; }

 private:
  void move_window(const TileWindow& window);
  void refresh_unit(const mapping::MapSnapshot& snapshot, UnitHandle handle);

  TileWindow window_;
  std::vector<std::uint32_t> slots_;  // by position in the window: the tile's units begin at slot · layers
  std::vector<std::uint32_t> free_slots_;
  std::vector<TileUnit> units_;
  std::vector<UnitHandle> removed_;
  std::vector<UnitHandle> changed_;
  std::uint32_t tiles_known_ = 0;
  QuantisationCounts quantisation_;
  std::array<float, protocol::kTileArea> values_{};
  QuantisedTile scratch_;
};

}  // namespace scree::node
