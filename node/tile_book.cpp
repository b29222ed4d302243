#include "node/tile_book.hpp"

#include <algorithm>

namespace scree::node {
namespace {

/// Ages of the same cells, not long after those that the unit holds.
bool only_older(const TileUnit& unit, const QuantisedTile& now, Time data_time) {
  if (unit.layer != protocol::Layer::cell_age) return false;
  const Duration since = data_time - unit.taken;
  if (since < Duration{0} || since >= kAgePeriod) return false;
  return std::equal(now.raw.begin(), now.raw.end(), unit.content.raw.begin(), [](std::int16_t a, std::int16_t b) {
    return (a == protocol::kUnknownU8) == (b == protocol::kUnknownU8);
  });
}

}  // namespace

void TileBook::update(const mapping::MapSnapshot& snapshot) {
  const TileWindow window = tiles_touched(snapshot.window);
  if (window != window_) move_window(window);
  tiles_known_ = 0;
  // layer by layer: under congestion every tile's cost goes before any tile's amplitude
  for (std::size_t layer = 0; layer < kPublishedLayers.size(); ++layer)
    for (Slot& slot : index_) refresh_unit(snapshot, slot[layer]);
}

void TileBook::refresh_unit(const mapping::MapSnapshot& snapshot, Units::iterator unit) {
  gather(snapshot, unit->layer, unit->tile, values_);
  quantise(unit->layer, values_, scratch_, quantisation_);
  if (unit->layer == protocol::Layer::cost)
    tiles_known_ += std::any_of(scratch_.raw.begin(), scratch_.raw.end(),
                                [](std::int16_t raw) { return raw != protocol::kUnknownU8; })
                        ? 1u
                        : 0u;
  if (unit->filled && (scratch_ == unit->content || only_older(*unit, scratch_, snapshot.data_time))) return;
  unit->content = scratch_;
  unit->taken = snapshot.data_time;
  unit->tile_rev = snapshot.revision;
  unit->changed = true;
  if (unit->filled && unit->pending) return;  // keeps its place
  pending_.splice(pending_.end(), unit->pending ? pending_ : sent_, unit);
  unit->filled = true;
  unit->pending = true;
}

void TileBook::move_window(const TileWindow& window) {
  std::vector<Slot> moved(static_cast<std::size_t>(window.tiles()));
  for (std::size_t position = 0; position < index_.size(); ++position) {
    const TileIndex tile = window_.tile(position);
    if (window.contains(tile)) {
      moved[window.position(tile)] = index_[position];
      continue;
    }
    for (const Units::iterator unit : index_[position]) (unit->pending ? pending_ : sent_).erase(unit);
  }
  for (std::size_t position = 0; position < moved.size(); ++position) {
    const TileIndex tile = window.tile(position);
    if (window_.contains(tile)) continue;
    for (std::size_t layer = 0; layer < kPublishedLayers.size(); ++layer) {
      TileUnit unit;
      unit.tile = tile;
      unit.layer = kPublishedLayers[layer];
      unit.pending = true;
      moved[position][layer] = pending_.insert(pending_.end(), unit);
    }
  }
  index_ = std::move(moved);
  window_ = window;
}

void TileBook::mark_sent(TileUnit& unit) {
  Units& from = unit.pending ? pending_ : sent_;
  unit.pending = false;
  unit.changed = false;
  sent_.splice(sent_.end(), from, from.begin());
}

void TileBook::mark_all_pending() {
  for (TileUnit& unit : sent_) unit.pending = true;
  pending_.splice(pending_.end(), sent_);
}

std::size_t TileBook::pending_blocks() const {
  std::size_t count = 0;
  for (const TileUnit& unit : pending_) count += static_cast<std::size_t>(block_count(unit.layer));
  return count;
}

std::size_t TileBook::blocks() const {
  std::size_t per_tile = 0;
  for (const protocol::Layer layer : kPublishedLayers) per_tile += static_cast<std::size_t>(block_count(layer));
  return index_.size() * per_tile;
}

}  // namespace scree::node
