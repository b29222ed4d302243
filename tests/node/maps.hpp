#pragma once
// Snapshots for the tests of the wire: every layer a function of the cell's place on the lattice.

#include <cmath>
#include <cstdint>
#include <gtest/gtest.h>
#include <limits>
#include <memory>

#include "core/random.hpp"
#include "mapping/snapshot.hpp"
#include "node/tile_quantise.hpp"
#include "node/tile_window.hpp"

namespace scree::test {

/// `variant` changes the content everywhere; about a fifth of the cells is unknown.
inline std::shared_ptr<mapping::MapSnapshot> make_snapshot(std::uint32_t revision, LatticeWindow window,
                                                           std::uint64_t variant = 0) {
  auto map = std::make_shared<mapping::MapSnapshot>();
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
  map->revision = revision;
  map->cell_m = 0.1;
  map->window = window;
  map->data_time = Time(std::chrono::seconds(1'700'000'000) + std::chrono::milliseconds(revision));
  map->received = MonotonicClock::now();
  map->cost.assign(window.rows, window.columns, mapping::kCostUnknown);
  map->state.assign(window.rows, window.columns, CellState::never_seen);
  map->hits.assign(window.rows, window.columns, 0);
  for (auto* grid : {&map->elevation_m, &map->elevation_sigma_m, &map->dimension, &map->dimension_sigma,
                     &map->amplitude_m, &map->slope_rad, &map->step_m, &map->cell_age_s})
    grid->assign(window.rows, window.columns, kNaN);
  for (int r = 0; r < window.rows; ++r) {
    for (int c = 0; c < window.columns; ++c) {
      const std::int32_t x = window.min.x + c, y = window.min.y + r;
      const auto words = random_words(variant, 0, x, y);
      if (words[0] % 5 == 0) continue;
      map->cost(r, c) = static_cast<std::uint8_t>(words[1] % 255);
      map->state(r, c) = words[0] % 5 == 1 ? CellState::reconstructed : CellState::measured;
      map->elevation_m(r, c) =
          static_cast<float>(3.0 * std::sin(0.05 * x) + 2.0 * std::cos(0.03 * y) + 0.1 * to_uniform(words[2]));
      if (words[0] % 5 == 1) continue;
      map->cell_age_s(r, c) = static_cast<float>(20.0 * to_uniform(words[1]));
      map->dimension(r, c) = static_cast<float>(2.0 + to_uniform(words[3]));
      map->amplitude_m(r, c) = static_cast<float>(0.3 * to_uniform(words[2] ^ words[3]));
    }
  }
  return map;
}

inline bool same_float(float a, float b) {
  return a == b || (std::isnan(a) && std::isnan(b));
}

/// What a perfect receiver holds of `map`: every published layer quantised and back.
inline std::shared_ptr<mapping::MapSnapshot> quantised(const mapping::MapSnapshot& map) {
  using node::protocol::Layer;
  auto out = std::make_shared<mapping::MapSnapshot>(map);
  const node::TileWindow tiles = node::tiles_touched(map.window);
  std::array<float, node::protocol::kTileArea> values;
  node::QuantisationCounts counts;
  node::QuantisedTile tile;
  for (std::size_t p = 0; p < static_cast<std::size_t>(tiles.tiles()); ++p) {
    for (const auto& [layer, grid] : {std::pair{Layer::elevation, &out->elevation_m},
                                      {Layer::dimension, &out->dimension},
                                      {Layer::amplitude, &out->amplitude_m}}) {
      node::gather(map, layer, tiles.tile(p), values);
      node::quantise(layer, values, tile, counts);
      for (int i = 0; i < node::protocol::kTileArea; ++i) {
        const int row = tiles.tile(p).ty * 32 + i / 32 - map.window.min.y;
        const int column = tiles.tile(p).tx * 32 + i % 32 - map.window.min.x;
        if (!grid->contains(row, column)) continue;
        const auto& scale = tile.scale[layer == Layer::elevation && i >= 512 ? 1 : 0];
        (*grid)(row, column) =
            node::dequantise(layer, tile.raw[static_cast<std::size_t>(i)], scale.scale, scale.offset);
      }
    }
  }
  return out;
}

/// Cells in which a received map differs from `expected`, over the five published layers; windows must agree.
inline std::size_t differing_cells(const mapping::MapSnapshot& received, const mapping::MapSnapshot& expected) {
  EXPECT_EQ(received.window, expected.window);
  if (!(received.window == expected.window)) return expected.cost.size();
  std::size_t count = 0;
  for (std::size_t i = 0; i < expected.cost.size(); ++i)
    count += received.cost[i] == expected.cost[i] && received.state[i] == expected.state[i] &&
                     same_float(received.elevation_m[i], expected.elevation_m[i]) &&
                     same_float(received.dimension[i], expected.dimension[i]) &&
                     same_float(received.amplitude_m[i], expected.amplitude_m[i])
                 ? 0u
                 : 1u;
  return count;
}

/// Cells of which anything at all is known.
inline std::size_t known_cells(const mapping::MapSnapshot& map) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < map.cost.size(); ++i)
    count += map.cost[i] != mapping::kCostUnknown || map.state[i] != CellState::never_seen ||
                     !std::isnan(map.elevation_m[i]) || !std::isnan(map.dimension[i]) || !std::isnan(map.amplitude_m[i])
                 ? 1u
                 : 0u;
  return count;
}

}  // namespace scree::test
