#include "node/listener_tiles.hpp"

#include <algorithm>
#include <limits>

namespace scree::node {
namespace {

using protocol::Layer;

/// The oldest revision among a tile's blocks.
template <class LayerTile>
std::uint32_t held_rev(const LayerTile& tile, int blocks) {
  std::uint32_t rev = tile.block[0].held ? tile.block[0].tile_rev : 0;
  if (blocks == 2) rev = std::min(rev, tile.block[1].held ? tile.block[1].tile_rev : 0);
  return rev;
}

Grid<float>* float_layer(mapping::MapSnapshot& map, Layer layer) {
  switch (layer) {
    case Layer::elevation:
      return &map.elevation_m;
    case Layer::dimension:
      return &map.dimension;
    case Layer::elevation_sigma:
      return &map.elevation_sigma_m;
    case Layer::slope:
      return &map.slope_rad;
    case Layer::step:
      return &map.step_m;
    case Layer::amplitude:
      return &map.amplitude_m;
    case Layer::dimension_sigma:
      return &map.dimension_sigma;
    case Layer::cell_age:
      return &map.cell_age_s;
    default:
      return nullptr;
  }
}

CellState state_from_raw(std::int16_t raw) {
  return raw <= static_cast<int>(CellState::measured) ? static_cast<CellState>(raw) : CellState::never_seen;
}

}  // namespace

void TileStore::set_window(const LatticeWindow& cells) {
  cells_ = cells;
  const TileWindow window = tiles_touched(cells);
  if (window == window_) return;
  std::vector<Slot> moved(static_cast<std::size_t>(window.tiles()));
  for (std::size_t position = 0; position < slots_.size(); ++position) {
    const TileIndex tile = window_.tile(position);
    if (window.contains(tile)) moved[window.position(tile)] = std::move(slots_[position]);
  }
  slots_ = std::move(moved);
  window_ = window;
}

void TileStore::forget_tiles() {
  for (Slot& slot : slots_)
    for (auto& tile : slot) tile.reset();
}

void TileStore::clear() {
  slots_.clear();
  window_ = {};
  cells_ = {};
}

TileStore::Taken TileStore::put(const protocol::TileBlock& block, MonotonicTime now) {
  if (!has_window()) return Taken::no_window;
  const TileIndex tile{block.tx, block.ty};
  if (!window_.contains(tile)) return Taken::outside;
  auto& held = slots_[window_.position(tile)][static_cast<std::size_t>(block.layer)];
  if (!held) held = std::make_unique<LayerTile>();
  const std::size_t part = block.row0 == 0 ? 0 : 1;
  Block& target = held->block[part];
  if (target.held && block.tile_rev < target.tile_rev) return Taken::outdated;

  target = {true, block.tile_rev, std::chrono::milliseconds(block.block_age_ms), now};
  held->content.scale[part] = {block.scale, block.offset};
  const auto raw = block.view();
  std::copy(raw.begin(), raw.end(), held->content.raw.begin() + block.row0 * protocol::kTileCells);
  if (held->outdated) {
    held->outdated = held_rev(*held, block_count(block.layer)) < held->wanted_rev;
    if (held->outdated_since != held->wanted_since) held->ask_at = held->wanted_since + kAskAfter;
    held->outdated_since = held->wanted_since;
  }
  return Taken::yes;
}

void TileStore::note(const protocol::Manifest& manifest, MonotonicTime now) {
  const auto layer = static_cast<std::size_t>(manifest.layer);
  const int blocks = block_count(static_cast<Layer>(manifest.layer));
  std::size_t i = 0;
  for (std::int32_t r = 0; r < manifest.rows; ++r) {
    for (std::int32_t c = 0; c < manifest.columns; ++c, ++i) {
      const TileIndex tile{manifest.tx0 + c, manifest.ty0 + r};
      if (!window_.contains(tile)) continue;
      auto& held = slots_[window_.position(tile)][layer];
      const std::uint32_t rev = manifest.tile_rev[i];
      if (rev == 0) continue;
      if (!held) held = std::make_unique<LayerTile>();  // it exists, and did not come yet
      if (rev <= held->wanted_rev) continue;
      held->wanted_rev = rev;
      held->wanted_since = now;
      if (!held->outdated && held_rev(*held, blocks) < rev) {
        held->outdated = true;
        held->outdated_since = now;
        held->ask_at = now + kAskAfter;
      }
    }
  }
}

bool TileStore::take_missing(MonotonicTime now, protocol::Nack& nack) {
  nack.count = 0;
  for (std::size_t position = 0; position < slots_.size() && nack.count < protocol::kMaxNackTiles; ++position) {
    LayerTile* const held = slots_[position][static_cast<std::size_t>(nack.layer)].get();
    if (held == nullptr || !held->outdated || now < held->ask_at) continue;
    held->ask_at = now + kAskAgain;
    nack.tiles[nack.count++] = window_.tile(position);
  }
  return nack.count > 0;
}

std::shared_ptr<mapping::MapSnapshot> TileStore::map(MonotonicTime now, Duration cell_max_age, bool valid) const {
  auto map = std::make_shared<mapping::MapSnapshot>();
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
  map->window = cells_;
  map->cost.assign(cells_.rows, cells_.columns, mapping::kCostUnknown);
  map->state.assign(cells_.rows, cells_.columns, CellState::never_seen);
  map->hits.assign(cells_.rows, cells_.columns, 0);
  for (const protocol::LayerFormat& format : protocol::kLayers)
    if (Grid<float>* const grid = float_layer(*map, format.layer)) grid->assign(cells_.rows, cells_.columns, kNaN);
  if (!valid) return map;

  for (std::size_t position = 0; position < slots_.size(); ++position) {
    for (const protocol::LayerFormat& format : protocol::kLayers) {
      const LayerTile* const held = slots_[position][static_cast<std::size_t>(format.layer)].get();
      if (held == nullptr || (held->outdated && now - held->outdated_since > kOutdatedAfter)) continue;
      for (int b = 0; b < block_count(format.layer); ++b) {
        const Block& block = held->block[static_cast<std::size_t>(b)];
        if (!block.held || (cell_max_age > Duration{0} && block.age + (now - block.arrived) > cell_max_age)) continue;
        draw(*map, window_.tile(position), format.layer, *held, b);
      }
    }
  }
  return map;
}

void TileStore::draw(mapping::MapSnapshot& map, TileIndex tile, Layer layer, const LayerTile& held, int block) const {
  Grid<float>* const floats = float_layer(map, layer);
  const auto [scale, offset] = held.content.scale[static_cast<std::size_t>(block)];
  const int block_rows = protocol::kTileCells / block_count(layer);
  for (int r = block * block_rows; r < (block + 1) * block_rows; ++r) {
    const std::int64_t row = std::int64_t{tile.ty} * protocol::kTileCells + r - cells_.min.y;
    if (row < 0 || row >= cells_.rows) continue;
    for (int c = 0; c < protocol::kTileCells; ++c) {
      const std::int64_t column = std::int64_t{tile.tx} * protocol::kTileCells + c - cells_.min.x;
      if (column < 0 || column >= cells_.columns) continue;
      const int y = static_cast<int>(row), x = static_cast<int>(column);
      const std::int16_t raw = held.content.raw[static_cast<std::size_t>(r * protocol::kTileCells + c)];
      if (floats != nullptr)
        (*floats)(y, x) = dequantise(layer, raw, scale, offset);
      else if (layer == Layer::cost)
        map.cost(y, x) = static_cast<std::uint8_t>(raw);
      else if (layer == Layer::cell_state)
        map.state(y, x) = state_from_raw(raw);
      else if (layer == Layer::hits)
        map.hits(y, x) = raw == protocol::kUnknownU8 ? std::uint16_t{0} : static_cast<std::uint16_t>(raw);
    }
  }
}

}  // namespace scree::node
