#include "tests/client/oracle.hpp"

#include <cmath>
#include <fmt/format.h>

namespace scree::test {
namespace {

using namespace node::protocol;
using node::TileIndex;

/// What a reader may make of one raw value; NaN = unknown.
float value_of(const TileBlock& block, std::size_t i) {
  const std::int16_t raw = block.raw[i];
  return raw == unknown_raw(block.layer) ? std::nanf("") : block.offset + block.scale * static_cast<float>(raw);
}

class BlockJudge {
 public:
  BlockJudge(const Shown& shown, const MapSender& sender) : shown_(shown), sender_(sender) {}

  void judge(Layer layer, TileIndex tile, int half, Judgement& out) const {
    const auto& history = sender_.revisions_of(tile);
    const Tally shown = tally(layer, tile, half, nullptr);
    out.known += shown.known;
    out.unknown += shown.cells - shown.known;
    if (shown.known == 0) return;  // right by being silent
    for (auto rev = history.rbegin(); rev != history.rend(); ++rev) {
      const TileBlock block = MapSender::content(sender_.settings().seed, layer, tile, *rev, half);
      if (tally(layer, tile, half, &block).equal != shown.cells) continue;
      if (rev != history.rbegin())
        out.revisions_behind = std::max(out.revisions_behind, sender_.revision() - *(rev - 1));
      return;
    }
    out.wrong += shown.known;
    if (out.first_wrong.empty())
      out.first_wrong = fmt::format("layer {} tile ({}, {}) half {}", static_cast<int>(layer), tile.tx, tile.ty, half);
  }

 private:
  struct Tally {
    std::uint64_t cells = 0, known = 0, equal = 0;
  };

  Tally tally(Layer layer, TileIndex tile, int half, const TileBlock* block) const {
    const client::Grid& grid = shown_.grid;
    const bool i16 = layer == Layer::elevation;
    Tally out;
    for (int r = i16 ? 16 * half : 0; r < (i16 ? 16 * half + 16 : 32); ++r) {
      for (int c = 0; c < 32; ++c) {
        const std::int64_t column = tile.tx * 32 + c - grid.x_min_cells, row = tile.ty * 32 + r - grid.y_min_cells;
        if (column < 0 || row < 0 || column >= grid.columns || row >= grid.rows) continue;
        const float value = shown_value(layer, static_cast<std::size_t>(row * grid.columns + column));
        ++out.cells;
        out.known += !std::isnan(value);
        if (block == nullptr) continue;
        const float sent = value_of(*block, static_cast<std::size_t>((r - (i16 ? 16 * half : 0)) * 32 + c));
        out.equal +=
            std::isnan(value) ? std::isnan(sent) : std::abs(value - sent) <= 1e-5F * std::max(1.0F, std::abs(sent));
      }
    }
    return out;
  }

  float shown_value(Layer layer, std::size_t i) const {
    if (layer == Layer::elevation) return shown_.elevation[i];
    if (layer == Layer::cell_state) return shown_.cell_state[i];
    const std::uint8_t cost = shown_.cost[i];
    if (shown_.occupancy[i] != client::Receiver::occupancy(cost)) return -1.0F;  // agrees with nothing
    return cost == client::kCostUnknown ? std::nanf("") : static_cast<float>(cost);
  }

  const Shown& shown_;
  const MapSender& sender_;
};

}  // namespace

Judgement judge(const Shown& shown, const MapSender& sender) {
  Judgement out;
  if (shown.grid.columns == 0) return out;
  const BlockJudge blocks(shown, sender);
  for (std::size_t t = 0; t < static_cast<std::size_t>(sender.tiles().tiles()); ++t) {
    const TileIndex tile = sender.tiles().tile(t);
    blocks.judge(Layer::cost, tile, 0, out);
    blocks.judge(Layer::elevation, tile, 0, out);
    blocks.judge(Layer::elevation, tile, 1, out);
    blocks.judge(Layer::cell_state, tile, 0, out);
  }
  return out;
}

bool all_unknown(const Shown& shown) {
  for (std::size_t i = 0; i < shown.cost.size(); ++i)
    if (shown.cost[i] != client::kCostUnknown || shown.occupancy[i] != -1 || !std::isnan(shown.elevation[i]) ||
        !std::isnan(shown.cell_state[i]))
      return false;
  return true;
}

}  // namespace scree::test
