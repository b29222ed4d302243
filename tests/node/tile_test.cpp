#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>

#include "node/tile_book.hpp"
#include "node/tile_quantise.hpp"
#include "tests/node/maps.hpp"

namespace scree::node {
namespace {

using protocol::Layer;
using Values = std::array<float, protocol::kTileArea>;

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

/// Largest |value − back| over the known cells; every cell must stay known or unknown.
double worst_error(Layer layer, const Values& values, QuantisedTile& tile, QuantisationCounts& counts) {
  quantise(layer, values, tile, counts);
  double worst = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto& scale = tile.scale[block_count(layer) == 2 && i >= 512 ? 1 : 0];
    const float back = dequantise(layer, tile.raw[i], scale.scale, scale.offset);
    EXPECT_EQ(std::isnan(back), std::isnan(values[i])) << i;
    if (!std::isnan(back)) worst = std::max(worst, std::abs(static_cast<double>(back) - values[i]));
  }
  return worst;
}

TEST(Quantise, ElevationErrorIsHalfAStepForAnyReliefAndHeight) {
  for (const double centre_m : {0.0, -410.3, 8848.7}) {
    for (const double relief_m : {0.01, 3.0, 15.9, 40.0, 3000.0}) {
      Values values;
      for (std::size_t i = 0; i < values.size(); ++i)
        values[i] = i % 7 == 0
                        ? kNaN
                        : static_cast<float>(
                              centre_m + relief_m * (to_uniform(random_words(1, 2, static_cast<int>(i), 0)[0]) - 0.5));
      QuantisedTile tile;
      QuantisationCounts counts;
      const double worst = worst_error(Layer::elevation, values, tile, counts);
      // half a step, and the rounding of the result to float (2^-24 relative)
      const double step = std::max(tile.scale[0].scale, tile.scale[1].scale);
      EXPECT_LE(worst, 0.5 * step + 6e-8 * (std::abs(centre_m) + relief_m));
      // the offset lies within half a metre of the middle, so the scale doubles only beyond ±7.5 m
      EXPECT_LE(step, relief_m < 15.0 ? 0x1p-12 : 2.0 * (0.5 * relief_m + 0.5) / 32767.0);
      EXPECT_EQ(counts.saturated, 0u);
    }
  }
}

TEST(Quantise, AmplitudeStepFollowsTheLargestOfTheTile) {
  Values values;
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = 0.2f * static_cast<float>(i) / 1023.0f;
  QuantisedTile tile;
  QuantisationCounts counts;
  const double worst = worst_error(Layer::amplitude, values, tile, counts);
  EXPECT_EQ(tile.scale[0].scale, 0x1p-10f);  // 254 · 2^-11 < 0.2 ≤ 254 · 2^-10
  EXPECT_LE(worst, 0x1p-11);
  EXPECT_EQ(counts.saturated, 0u);
}

TEST(Quantise, ValuesBeyondTheRangeSaturateAndAreCounted) {
  Values values;
  values.fill(0.1f);
  values[3] = 100.0f;  // amplitude ends at 254 · 2^-5 = 7.94 m
  QuantisedTile tile;
  QuantisationCounts counts;
  quantise(Layer::amplitude, values, tile, counts);
  EXPECT_EQ(tile.raw[3], 254);
  EXPECT_EQ(counts.saturated, 1u);
  values.fill(2.5f);
  values[0] = 1.75f;
  values[1] = 3.25f;
  quantise(Layer::dimension, values, tile, counts);
  EXPECT_EQ(tile.raw[0], 0);
  EXPECT_EQ(tile.raw[1], 254);
  EXPECT_EQ(tile.raw[2], 127);
  EXPECT_EQ(counts.saturated, 3u);
}

TEST(Quantise, NothingInfiniteIsKnown) {
  Values values;
  values.fill(1.0f);
  values[5] = std::numeric_limits<float>::infinity();
  values[6] = -std::numeric_limits<float>::infinity();
  values[7] = kNaN;
  QuantisedTile tile;
  QuantisationCounts counts;
  for (const Layer layer : {Layer::elevation, Layer::amplitude, Layer::slope}) {
    quantise(layer, values, tile, counts);
    for (const std::size_t i : {5u, 6u, 7u}) EXPECT_EQ(tile.raw[i], protocol::unknown_raw(layer));
    EXPECT_NE(tile.raw[8], protocol::unknown_raw(layer));
  }
}

TEST(Gather, CellsOutsideTheWindowAreUnknownAndCostsExact) {
  const auto map = test::make_snapshot(1, {{-5, 30}, 10, 12});
  Values values;
  for (const TileIndex tile : {TileIndex{-1, 0}, {0, 0}, {-1, 1}, {0, 1}, {5, 5}}) {
    gather(*map, Layer::cost, tile, values);
    for (int i = 0; i < protocol::kTileArea; ++i) {
      const CellIndex cell{tile.tx * 32 + i % 32, tile.ty * 32 + i / 32};
      const float value = values[static_cast<std::size_t>(i)];
      if (!map->window.contains(cell)) {
        EXPECT_TRUE(std::isnan(value));
        continue;
      }
      const std::uint8_t cost = map->cost(cell.y - 30, cell.x + 5);
      EXPECT_TRUE(cost == 255 ? std::isnan(value) : value == cost);
    }
  }
}

/// Sends everything that is pending; returns how many units that were.
std::size_t drain(TileBook& book) {
  std::size_t count = 0;
  while (TileUnit* const unit = book.next_pending()) {
    book.mark_sent(*unit);
    ++count;
  }
  return count;
}

TEST(TileBook, OnlyChangedLayersOfChangedTilesArePending) {
  TileBook book;
  book.update(*test::make_snapshot(1, {{0, 0}, 64, 64}));
  EXPECT_EQ(drain(book), 4 * kPublishedLayers.size());
  auto map = test::make_snapshot(2, {{0, 0}, 64, 64});
  book.update(*map);
  EXPECT_FALSE(book.has_pending());
  map = test::make_snapshot(3, {{0, 0}, 64, 64});
  map->cost(40, 3) = map->cost(40, 3) == 7 ? 8 : 7;
  book.update(*map);
  ASSERT_TRUE(book.has_pending());
  EXPECT_EQ(book.next_pending()->tile, (TileIndex{0, 1}));
  EXPECT_EQ(book.next_pending()->layer, Layer::cost);
  EXPECT_EQ(book.next_pending()->tile_rev, 3u);
  EXPECT_EQ(drain(book), 1u);
  EXPECT_EQ(book.tile_rev(2, 0), 3u);
  EXPECT_EQ(book.tile_rev(1, 0), 1u);
}

// Ages that only grow are sent once a second, and at once where cells become known.
TEST(TileBook, GrowingAgesMakeATileChangeOnceASecond) {
  const LatticeWindow window{{0, 0}, 32, 32};
  TileBook book;
  const auto aged = [&](std::uint32_t revision, float seconds) {
    auto map = test::make_snapshot(revision, window);
    map->data_time = Time(std::chrono::seconds(100)) + from_seconds(static_cast<double>(seconds));
    for (float& age : map->cell_age_s) age += seconds;
    return map;
  };
  book.update(*aged(1, 0.0F));
  drain(book);
  for (std::uint32_t k = 1; k < 10; ++k) {
    book.update(*aged(1 + k, 0.1F * static_cast<float>(k)));
    EXPECT_FALSE(book.has_pending()) << k;
  }
  book.update(*aged(11, 1.0F));
  ASSERT_TRUE(book.has_pending());
  EXPECT_EQ(book.next_pending()->layer, Layer::cell_age);
  EXPECT_EQ(book.next_pending()->tile_rev, 11u);
  EXPECT_EQ(drain(book), 1u);
  auto map = aged(12, 1.1F);
  for (float& age : map->cell_age_s)
    if (std::isnan(age)) {
      age = 0.0F;  // a cell that is measured now
      break;
    }
  book.update(*map);
  EXPECT_EQ(drain(book), 1u);
}

TEST(TileBook, ChangeThatIsTakenBackBeforeItWasSentIsStillSent) {
  TileBook book;
  book.update(*test::make_snapshot(1, {{0, 0}, 32, 32}));
  drain(book);
  book.update(*test::make_snapshot(2, {{0, 0}, 32, 32}, 1));
  book.update(*test::make_snapshot(3, {{0, 0}, 32, 32}, 0));  // tile_rev is 3 now: receivers wait for it
  EXPECT_EQ(book.next_pending()->tile_rev, 3u);
  EXPECT_EQ(drain(book), kPublishedLayers.size());
}

TEST(TileBook, RollingWindowForgetsTilesAndSendsNewOnes) {
  TileBook book;
  book.update(*test::make_snapshot(1, {{0, 0}, 64, 96}));
  drain(book);
  book.update(*test::make_snapshot(2, {{32, 0}, 64, 96}));
  EXPECT_EQ(drain(book), 2 * kPublishedLayers.size());  // the two tiles of column 3
  EXPECT_EQ(book.units(), 6 * kPublishedLayers.size());
  EXPECT_EQ(book.tile_rev(0, 0), 1u);
  book.update(*test::make_snapshot(3, {{33, 0}, 64, 96}));
  // column 1 loses a row of cells, column 4 enters with one
  EXPECT_EQ(drain(book), 4 * kPublishedLayers.size());
}

TEST(TileBook, LeastRecentlySentGoesRound) {
  TileBook book;
  book.update(*test::make_snapshot(1, {{0, 0}, 64, 64}));
  drain(book);
  std::vector<TileUnit*> order;
  for (std::size_t i = 0; i < book.units(); ++i) {
    order.push_back(book.least_recently_sent());
    book.mark_sent(*order.back());
  }
  EXPECT_EQ(book.least_recently_sent(), order.front());
  std::sort(order.begin(), order.end());
  EXPECT_EQ(std::unique(order.begin(), order.end()), order.end());
}

}  // namespace
}  // namespace scree::node
