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
  removed_.clear();
  changed_.clear();
  const TileWindow window = tiles_touched(snapshot.window);
  if (window != window_) move_window(window);
  tiles_known_ = 0;
  for (std::size_t layer = 0; layer < kPublishedLayers.size(); ++layer)
    for (std::size_t position = 0; position < slots_.size(); ++position) refresh_unit(snapshot, at(position, layer));
}

void TileBook::refresh_unit(const mapping::MapSnapshot& snapshot, UnitHandle handle) {
  TileUnit& unit = units_[handle];
  gather(snapshot, unit.layer, unit.tile, values_);
  quantise(unit.layer, values_, scratch_, quantisation_);
  if (unit.layer == protocol::Layer::cost)
    tiles_known_ += std::any_of(scratch_.raw.begin(), scratch_.raw.end(),
                                [](std::int16_t raw) { return raw != protocol::kUnknownU8; })
                        ? 1u
                        : 0u;
  if (unit.filled && (scratch_ == unit.content || only_older(unit, scratch_, snapshot.data_time))) return;
  unit.content = scratch_;
  unit.taken = snapshot.data_time;
  unit.tile_rev = snapshot.revision;
  unit.filled = true;
  changed_.push_back(handle);
}

void TileBook::move_window(const TileWindow& window) {
  constexpr auto kLayers = static_cast<UnitHandle>(kPublishedLayers.size());
  constexpr auto kNone = static_cast<std::uint32_t>(-1);
  std::vector<std::uint32_t> moved(static_cast<std::size_t>(window.tiles()), kNone);
  for (std::size_t position = 0; position < slots_.size(); ++position) {
    const TileIndex tile = window_.tile(position);
    if (window.contains(tile)) {
      moved[window.position(tile)] = slots_[position];
      continue;
    }
    free_slots_.push_back(slots_[position]);
    for (UnitHandle layer = 0; layer < kLayers; ++layer) removed_.push_back(slots_[position] * kLayers + layer);
  }
  for (std::size_t position = 0; position < moved.size(); ++position) {
    if (moved[position] != kNone) continue;
    if (free_slots_.empty()) {
      free_slots_.push_back(static_cast<std::uint32_t>(units_.size() / kLayers));
      units_.resize(units_.size() + kLayers);
    }
    moved[position] = free_slots_.back();
    free_slots_.pop_back();
    for (UnitHandle layer = 0; layer < kLayers; ++layer) {
      TileUnit& unit = units_[moved[position] * kLayers + layer];
      unit.tile = window.tile(position);
      unit.layer = kPublishedLayers[layer];
      unit.filled = false;
    }
  }
  slots_ = std::move(moved);
  window_ = window;
}

std::optional<UnitHandle> TileBook::find(TileIndex tile, protocol::Layer layer) const {
  const auto published = std::find(kPublishedLayers.begin(), kPublishedLayers.end(), layer);
  if (published == kPublishedLayers.end() || !window_.contains(tile)) return std::nullopt;
  return at(window_.position(tile), static_cast<std::size_t>(published - kPublishedLayers.begin()));
}

}  // namespace scree::node
