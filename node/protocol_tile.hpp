#pragma once
// TILE: one block of one layer, complete in one datagram.

#include <array>
#include <cstdint>
#include <span>

#include "node/protocol_header.hpp"
#include "node/protocol_layers.hpp"

namespace scree::node::protocol {

inline constexpr int kTileLog2 = 5;
inline constexpr int kTileCells = 1 << kTileLog2;          ///< along a side
inline constexpr int kTileArea = kTileCells * kTileCells;  ///< 1024
inline constexpr int kHalfRows = kTileCells / 2;           ///< rows of a 16-bit block
inline constexpr std::size_t kTileHeaderBytes = 32;
inline constexpr std::int32_t kTileIndexLimit = 1 << 26;  ///< |tx|, |ty| below: cells fit an i32

struct TileBlock {
  std::int32_t tx = 0;
  std::int32_t ty = 0;
  std::uint32_t tile_rev = 0;
  Layer layer = Layer::cost;
  std::uint8_t row0 = 0;
  std::uint8_t rows = kTileCells;  ///< 32 from row0 = 0; layers of 16 bits: 16 from row0 = 0 or 16
  float scale = 1.0f;              ///< value = offset + scale·raw; finite, scale > 0
  float offset = 0.0f;
  std::uint32_t block_age_ms = 0;
  /// Raw values, row-major, the first rows·32 of them; unknown_raw(layer) = unknown.
  std::array<std::int16_t, kTileArea> raw{};

  int cells() const { return rows * kTileCells; }
  std::span<const std::int16_t> view() const { return std::span(raw).first(static_cast<std::size_t>(cells())); }
  std::uint16_t known_cells() const;
};

/// True for the row ranges that a layer's blocks have in version 1.
bool valid_rows(Layer layer, int row0, int rows);

/// Encodes with the shortest of constant, run-length (u8 only) and raw. `header.type` is set. `block` must be valid
/// (valid_rows; raw values within the layer's type).
void encode(Header header, const TileBlock& block, Datagram& out, const Key* key = nullptr);

/// Reject::layer, body_length or body_value; `out` is unspecified then.
Reject decode(const Opened& opened, TileBlock& out);

}  // namespace scree::node::protocol
