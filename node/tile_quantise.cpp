#include "node/tile_quantise.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace scree::node {
namespace {

using protocol::Layer;
using protocol::LayerFormat;
using protocol::ScaleRule;

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr int kMaxU8 = 254;
constexpr int kMaxI16 = 32767;

struct Extent {
  float low = std::numeric_limits<float>::infinity();
  float high = -std::numeric_limits<float>::infinity();
  bool empty() const { return low > high; }
};

/// Of the finite values.
Extent extent_of(std::span<const float> values) {
  Extent extent;
  for (const float value : values) {
    if (!std::isfinite(value)) continue;
    extent.low = std::min(extent.low, value);
    extent.high = std::max(extent.high, value);
  }
  return extent;
}

/// The smallest doubling of `finest` with `reach` ≤ steps · scale, but not above `coarsest`.
float ladder_scale(double reach, int steps, float finest, float coarsest) {
  float scale = finest;
  while (scale < coarsest && reach > static_cast<double>(scale) * steps) scale *= 2.0f;
  return scale;
}

QuantisedTile::Scale choose_scale(const LayerFormat& format, std::span<const float> values) {
  if (format.rule == ScaleRule::fixed) return {format.scale, format.offset};
  const Extent extent = extent_of(values);
  if (extent.empty()) return {format.scale, format.offset};
  if (format.rule == ScaleRule::ladder)
    return {ladder_scale(extent.high, kMaxU8, format.scale, format.max_scale), format.offset};
  // A whole metre as offset: it moves rarely, so unchanged cells keep their bytes, and it is exact in a float.
  const auto centre = static_cast<float>(std::round(0.5 * (static_cast<double>(extent.low) + extent.high)));
  const double reach = std::max(static_cast<double>(extent.high) - centre, centre - static_cast<double>(extent.low));
  return {ladder_scale(reach, kMaxI16, format.scale, format.max_scale), centre};
}

void quantise_cells(const LayerFormat& format, QuantisedTile::Scale scale, std::span<const float> values,
                    std::span<std::int16_t> raw, QuantisationCounts& counts) {
  const bool wide = format.encoding == protocol::Encoding::i16;
  const double low = wide ? -kMaxI16 : 0.0, high = wide ? kMaxI16 : kMaxU8;
  const double inverse = 1.0 / static_cast<double>(scale.scale);
  const double offset = scale.offset;
  const std::int16_t unknown = protocol::unknown_raw(format.layer);
  std::uint64_t saturated = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double value = values[i];
    const double steps = std::floor((value - offset) * inverse + 0.5);
    const double clamped = std::min(std::max(steps, low), high);
    const bool known = std::abs(value) <= std::numeric_limits<float>::max();  // false for NaN and infinities
    raw[i] = known ? static_cast<std::int16_t>(clamped) : unknown;
    saturated += (known && clamped != steps) ? 1u : 0u;
  }
  counts.saturated += saturated;
}

template <class Value>
void gather_cells(const mapping::MapSnapshot& snapshot, TileIndex tile, std::span<float, protocol::kTileArea> values,
                  Value value_at) {
  const std::int64_t x0 = std::int64_t{tile.tx} * protocol::kTileCells - snapshot.window.min.x;
  const std::int64_t y0 = std::int64_t{tile.ty} * protocol::kTileCells - snapshot.window.min.y;
  const auto begin = static_cast<int>(std::clamp<std::int64_t>(-x0, 0, protocol::kTileCells));
  const auto end =
      static_cast<int>(std::clamp<std::int64_t>(snapshot.window.columns - x0, begin, protocol::kTileCells));
  for (int r = 0; r < protocol::kTileCells; ++r) {
    const std::int64_t row = y0 + r;
    float* const out = values.data() + r * protocol::kTileCells;
    std::fill_n(out, protocol::kTileCells, kNaN);
    if (row < 0 || row >= snapshot.window.rows) continue;
    for (int c = begin; c < end; ++c) out[c] = value_at(static_cast<int>(row), static_cast<int>(x0 + c));
  }
}

}  // namespace

void gather(const mapping::MapSnapshot& snapshot, Layer layer, TileIndex tile,
            std::span<float, protocol::kTileArea> values) {
  const auto floats = [&](const Grid<float>& grid) {
    gather_cells(snapshot, tile, values, [&](int row, int column) { return grid(row, column); });
  };
  switch (layer) {
    case Layer::cost:
      return gather_cells(snapshot, tile, values, [&](int row, int column) {
        const std::uint8_t cost = snapshot.cost(row, column);
        return cost == mapping::kCostUnknown ? kNaN : static_cast<float>(cost);
      });
    case Layer::cell_state:
      return gather_cells(snapshot, tile, values,
                          [&](int row, int column) { return static_cast<float>(snapshot.state(row, column)); });
    case Layer::hits:
      return gather_cells(snapshot, tile, values,
                          [&](int row, int column) { return static_cast<float>(snapshot.hits(row, column)); });
    case Layer::elevation:
      return floats(snapshot.elevation_m);
    case Layer::dimension:
      return floats(snapshot.dimension);
    case Layer::elevation_sigma:
      return floats(snapshot.elevation_sigma_m);
    case Layer::slope:
      return floats(snapshot.slope_rad);
    case Layer::step:
      return floats(snapshot.step_m);
    case Layer::amplitude:
      return floats(snapshot.amplitude_m);
    case Layer::dimension_sigma:
      return floats(snapshot.dimension_sigma);
    case Layer::cell_age:
      if (snapshot.cell_age_s.empty()) break;  // a received map without it
      return floats(snapshot.cell_age_s);
  }
  std::fill(values.begin(), values.end(), kNaN);
}

int block_count(Layer layer) {
  return protocol::layer_format(layer).encoding == protocol::Encoding::i16 ? 2 : 1;
}

void quantise(Layer layer, std::span<const float, protocol::kTileArea> values, QuantisedTile& out,
              QuantisationCounts& counts) {
  const LayerFormat& format = protocol::layer_format(layer);
  const auto blocks = static_cast<std::size_t>(block_count(layer));
  const std::size_t cells = protocol::kTileArea / blocks;
  out.scale = {};
  for (std::size_t b = 0; b < blocks; ++b) {
    const std::span<const float> part = values.subspan(b * cells, cells);
    out.scale[b] = choose_scale(format, part);
    quantise_cells(format, out.scale[b], part, std::span(out.raw).subspan(b * cells, cells), counts);
  }
}

void copy_block(const QuantisedTile& tile, Layer layer, int index, protocol::TileBlock& block) {
  const int rows = protocol::kTileCells / block_count(layer);
  block.layer = layer;
  block.row0 = static_cast<std::uint8_t>(index * rows);
  block.rows = static_cast<std::uint8_t>(rows);
  block.scale = tile.scale[static_cast<std::size_t>(index)].scale;
  block.offset = tile.scale[static_cast<std::size_t>(index)].offset;
  std::copy_n(tile.raw.begin() + index * rows * protocol::kTileCells, rows * protocol::kTileCells, block.raw.begin());
}

float dequantise(Layer layer, std::int16_t raw, float scale, float offset) {
  if (raw == protocol::unknown_raw(layer)) return kNaN;
  return static_cast<float>(static_cast<double>(offset) + static_cast<double>(scale) * raw);
}

}  // namespace scree::node
