#pragma once
// From a snapshot's metres to the raw values of a tile, and back.

#include <array>
#include <cstdint>
#include <span>

#include "mapping/snapshot.hpp"
#include "node/protocol_tile.hpp"
#include "node/tile_window.hpp"

namespace scree::node {

/// One layer of one tile as it goes on the wire: one block, or two of 16 rows for a 16-bit layer.
struct QuantisedTile {
  struct Scale {
    float scale = 1.0f;
    float offset = 0.0f;
    friend bool operator==(const Scale&, const Scale&) = default;
  };
  std::array<std::int16_t, protocol::kTileArea> raw{};
  std::array<Scale, 2> scale{};  ///< of the lower and of the upper half; 8-bit layers use the first

  friend bool operator==(const QuantisedTile&, const QuantisedTile&) = default;
};

/// Cells whose value could not be carried as it was.
struct QuantisationCounts {
  std::uint64_t saturated = 0;  ///< moved to the end of the layer's range
};

/// Values of one layer in a tile, row-major; NaN = unknown or outside the snapshot's window. Costs and states are
/// exact.
void gather(const mapping::MapSnapshot& snapshot, protocol::Layer layer, TileIndex tile,
            std::span<float, protocol::kTileArea> values);

/// Quantises to the layer's rule. Errors: |value − back| ≤ scale/2 for every value that is not saturated. Elevation is
/// never saturated: its scale grows by powers of two until the half tile fits.
void quantise(protocol::Layer layer, std::span<const float, protocol::kTileArea> values, QuantisedTile& out,
              QuantisationCounts& counts);

/// Blocks of a layer's tile: 1, or 2 for 16-bit layers.
int block_count(protocol::Layer layer);

/// Fills layer, rows, scale, offset and raw of `block`.
void copy_block(const QuantisedTile& tile, protocol::Layer layer, int index, protocol::TileBlock& block);

/// offset + scale·raw in double, rounded to float once; NaN for the unknown value.
float dequantise(protocol::Layer layer, std::int16_t raw, float scale, float offset);

}  // namespace scree::node
