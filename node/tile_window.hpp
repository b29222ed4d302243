#pragma once
// Tiles: squares of 32 × 32 cells of the world lattice. Tile (tx, ty) begins at cell (32·tx, 32·ty).

#include <cstdint>

#include "core/grid.hpp"
#include "node/protocol_tile.hpp"

namespace scree::node {

struct TileIndex {
  std::int32_t tx = 0;
  std::int32_t ty = 0;
  friend bool operator==(const TileIndex&, const TileIndex&) = default;
};

/// The tile that holds a cell coordinate (floor, also below zero).
constexpr std::int32_t tile_of(std::int32_t cell) {
  return cell >> protocol::kTileLog2;
}

/// A rectangle of tiles: min.tx … min.tx+columns−1 by min.ty … min.ty+rows−1.
struct TileWindow {
  TileIndex min;
  std::int32_t rows = 0;
  std::int32_t columns = 0;

  std::int64_t tiles() const { return std::int64_t{rows} * columns; }
  bool contains(TileIndex tile) const {
    return tile.tx >= min.tx && tile.tx - min.tx < columns && tile.ty >= min.ty && tile.ty - min.ty < rows;
  }
  /// Row-major position of a tile that the window contains.
  std::size_t position(TileIndex tile) const {
    return static_cast<std::size_t>(tile.ty - min.ty) * static_cast<std::size_t>(columns) +
           static_cast<std::size_t>(tile.tx - min.tx);
  }
  TileIndex tile(std::size_t position) const {
    const auto width = static_cast<std::size_t>(columns);
    return {min.tx + static_cast<std::int32_t>(position % width), min.ty + static_cast<std::int32_t>(position / width)};
  }
  friend bool operator==(const TileWindow&, const TileWindow&) = default;
};

/// The tiles that a window of cells touches. The window must not be empty and end below 2^31.
constexpr TileWindow tiles_touched(const LatticeWindow& window) {
  const TileIndex min{tile_of(window.min.x), tile_of(window.min.y)};
  return {min, tile_of(window.min.y + window.rows - 1) - min.ty + 1,
          tile_of(window.min.x + window.columns - 1) - min.tx + 1};
}

}  // namespace scree::node
