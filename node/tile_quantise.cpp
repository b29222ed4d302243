#include "node/tile_quantise.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/simd.hpp"

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

/// Of the finite values; their number is a multiple of the lanes. Minimum and maximum do not depend on the order, but
/// the compiler must be told so: a lane each.
SCREE_CLONES Extent extent_of(std::span<const float> values) {
  constexpr std::size_t kLanes = 16;
  std::array<float, kLanes> low, high;
  low.fill(Extent{}.low);
  high.fill(Extent{}.high);
  for (std::size_t i = 0; i < values.size(); i += kLanes) {
    for (std::size_t k = 0; k < kLanes; ++k) {
      const float value = values[i + k];
      const bool finite = std::abs(value) <= std::numeric_limits<float>::max();  // false for NaN too
      low[k] = finite && value < low[k] ? value : low[k];
      high[k] = finite && value > high[k] ? value : high[k];
    }
  }
  return {*std::min_element(low.begin(), low.end()), *std::max_element(high.begin(), high.end())};
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

struct CellRule {
  double low, high;
  double inverse;
  double offset;
  int unknown;
};

/// Returns how many were saturated. In doubles, so that scale/2 bounds the error of large heights too. Half steps go
/// up; far from zero the truncation of a conversion is a floor, which vectorises everywhere.
SCREE_CLONES int quantise_cells(const CellRule& given, const float* values, std::int16_t* raw, int count) {
  const CellRule rule = given;  // not to be read again for every cell
  constexpr double kFar = 65536.0;
  const int lowest = static_cast<int>(rule.low), highest = static_cast<int>(rule.high);
  int saturated = 0;
  for (int i = 0; i < count; ++i) {
    const double steps = (static_cast<double>(values[i]) - rule.offset) * rule.inverse;
    const double above = steps > rule.low - 1.0 ? steps : rule.low - 1.0;  // NaN too, which becomes unknown
    const double within = above < rule.high + 1.0 ? above : rule.high + 1.0;
    const int rounded = static_cast<int>(within + (kFar + 0.5)) - static_cast<int>(kFar);
    const int clamped = std::min(std::max(rounded, lowest), highest);
    const int known = std::abs(values[i]) <= std::numeric_limits<float>::max() ? -1 : 0;  // 0 for NaN
    raw[i] = static_cast<std::int16_t>((clamped & known) | (rule.unknown & ~known));
    saturated += known & (clamped != rounded ? 1 : 0);
  }
  return saturated;
}

CellRule cell_rule(const LayerFormat& format, QuantisedTile::Scale scale) {
  const bool wide = format.encoding == protocol::Encoding::i16;
  return {wide ? -double{kMaxI16} : 0.0, wide ? double{kMaxI16} : double{kMaxU8},
          1.0 / static_cast<double>(scale.scale), static_cast<double>(scale.offset),
          protocol::unknown_raw(format.layer)};
}

/// `convert` makes a float of a cell.
template <class Cell, class Convert>
void gather_cells(const mapping::MapSnapshot& snapshot, const Grid<Cell>& grid, TileIndex tile,
                  std::span<float, protocol::kTileArea> values, Convert convert) {
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
    if (begin == end) continue;
    const Cell* const in = &grid(static_cast<int>(row), static_cast<int>(x0 + begin));
    for (int c = 0; c < end - begin; ++c) out[begin + c] = convert(in[c]);
  }
}

}  // namespace

void gather(const mapping::MapSnapshot& snapshot, Layer layer, TileIndex tile,
            std::span<float, protocol::kTileArea> values) {
  const auto floats = [&](const Grid<float>& grid) {
    gather_cells(snapshot, grid, tile, values, [](float value) { return value; });
  };
  switch (layer) {
    case Layer::cost:
      return gather_cells(snapshot, snapshot.cost, tile, values, [](std::uint8_t cost) {
        return cost == mapping::kCostUnknown ? kNaN : static_cast<float>(cost);
      });
    case Layer::cell_state:
      return gather_cells(snapshot, snapshot.state, tile, values,
                          [](CellState state) { return static_cast<float>(state); });
    case Layer::hits:
      return gather_cells(snapshot, snapshot.hits, tile, values,
                          [](std::uint16_t hits) { return static_cast<float>(hits); });
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
    counts.saturated += static_cast<std::uint64_t>(quantise_cells(cell_rule(format, out.scale[b]), part.data(),
                                                                  out.raw.data() + b * cells, static_cast<int>(cells)));
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
