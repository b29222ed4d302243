#pragma once
// The blocks a receiver holds, and the map that they make.

#include <array>
#include <memory>
#include <vector>

#include "mapping/snapshot.hpp"
#include "node/protocol.hpp"
#include "node/tile_quantise.hpp"
#include "node/tile_window.hpp"

namespace scree::node {

/// A tile older than its MANIFEST for longer than this reads as unknown.
inline constexpr Duration kOutdatedAfter = std::chrono::milliseconds(500);
/// A tile older than its MANIFEST is asked for after this time: most are only late …
inline constexpr Duration kAskAfter = std::chrono::milliseconds(50);
/// … and again after this.
inline constexpr Duration kAskAgain = std::chrono::milliseconds(100);

class TileStore {
 public:
  enum class Taken : std::uint8_t { yes, no_window, outside, outdated };

  /// Tiles outside the new window are forgotten. Memory is bounded by protocol::kMaxWindowTiles.
  void set_window(const LatticeWindow& cells);
  void forget_tiles();
  /// Also the window.
  void clear();

  /// Keeps the block unless a newer revision of it is held. An equal one renews its age.
  Taken put(const protocol::TileBlock& block, MonotonicTime now);
  /// Remembers which tiles are older than the manifest says. `manifest.layer` must be known.
  void note(const protocol::Manifest& manifest, MonotonicTime now);

  /// Tiles of `nack.layer` that are to be asked for now, into `nack`; false when there are none (left). They are taken
  /// as asked for. Walks the window.
  bool take_missing(MonotonicTime now, protocol::Nack& nack);

  bool has_window() const { return window_.columns > 0; }

  /// All layers on the window's cells; blocks that are outdated, or older than `cell_max_age` (0 = no limit), are
  /// unknown, and all of them are without `valid`.
  std::shared_ptr<mapping::MapSnapshot> map(MonotonicTime now, Duration cell_max_age, bool valid) const;

 private:
  struct Block {
    bool held = false;
    std::uint32_t tile_rev = 0;
    Duration age{0};  ///< on arrival
    MonotonicTime arrived;
  };
  struct LayerTile {
    QuantisedTile content;
    std::array<Block, 2> block;
    bool outdated = false;  ///< a manifest named `wanted_rev`, newer than a block here
    std::uint32_t wanted_rev = 0;
    MonotonicTime outdated_since;
    MonotonicTime wanted_since;  ///< when wanted_rev last grew
    MonotonicTime ask_at;        ///< while outdated
  };
  using Slot = std::array<std::unique_ptr<LayerTile>, protocol::kLayerCount>;

  void draw(mapping::MapSnapshot& map, TileIndex tile, protocol::Layer layer, const LayerTile& held, int block) const;

  LatticeWindow cells_;
  TileWindow window_;
  std::vector<Slot> slots_;
};

}  // namespace scree::node
