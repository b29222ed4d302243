#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>

#include "node/send_queue.hpp"
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

/// A book and one destination of everything in it.
struct Desk {
  TileBook book;
  SendQueue queue;
  std::uint64_t generation = 0;

  void update(const mapping::MapSnapshot& map) {
    book.update(map);
    ++generation;
    queue.reserve(book.handles());
    for (const UnitHandle handle : book.removed()) queue.remove(handle);
    for (const UnitHandle handle : book.changed())
      queue.change(handle, block_count(book.unit(handle).layer), generation);
  }
  const TileUnit& next() const { return book.unit(*queue.next_pending()); }
  /// Sends everything that is pending; returns how many units that were.
  std::size_t drain() {
    std::size_t count = 0;
    for (; queue.has_pending(); ++count) queue.mark_sent(*queue.next_pending(), 0, {});
    return count;
  }
};

TEST(TileBook, OnlyChangedLayersOfChangedTilesArePending) {
  Desk desk;
  desk.update(*test::make_snapshot(1, {{0, 0}, 64, 64}));
  EXPECT_EQ(desk.drain(), 4 * kPublishedLayers.size());
  auto map = test::make_snapshot(2, {{0, 0}, 64, 64});
  desk.update(*map);
  EXPECT_FALSE(desk.queue.has_pending());
  map = test::make_snapshot(3, {{0, 0}, 64, 64});
  map->cost(40, 3) = map->cost(40, 3) == 7 ? 8 : 7;
  desk.update(*map);
  ASSERT_TRUE(desk.queue.has_pending());
  EXPECT_EQ(desk.next().tile, (TileIndex{0, 1}));
  EXPECT_EQ(desk.next().layer, Layer::cost);
  EXPECT_EQ(desk.next().tile_rev, 3u);
  EXPECT_EQ(desk.drain(), 1u);
  EXPECT_EQ(desk.book.tile_rev(2, 0), 3u);
  EXPECT_EQ(desk.book.tile_rev(1, 0), 1u);
}

// Ages that only grow are sent once a second, and at once where cells become known.
TEST(TileBook, GrowingAgesMakeATileChangeOnceASecond) {
  const LatticeWindow window{{0, 0}, 32, 32};
  Desk desk;
  const auto aged = [&](std::uint32_t revision, float seconds) {
    auto map = test::make_snapshot(revision, window);
    map->data_time = Time(std::chrono::seconds(100)) + from_seconds(static_cast<double>(seconds));
    for (float& age : map->cell_age_s) age += seconds;
    return map;
  };
  desk.update(*aged(1, 0.0F));
  desk.drain();
  for (std::uint32_t k = 1; k < 10; ++k) {
    desk.update(*aged(1 + k, 0.1F * static_cast<float>(k)));
    EXPECT_FALSE(desk.queue.has_pending()) << k;
  }
  desk.update(*aged(11, 1.0F));
  ASSERT_TRUE(desk.queue.has_pending());
  EXPECT_EQ(desk.next().layer, Layer::cell_age);
  EXPECT_EQ(desk.next().tile_rev, 11u);
  EXPECT_EQ(desk.drain(), 1u);
  auto map = aged(12, 1.1F);
  for (float& age : map->cell_age_s)
    if (std::isnan(age)) {
      age = 0.0F;  // a cell that is measured now
      break;
    }
  desk.update(*map);
  EXPECT_EQ(desk.drain(), 1u);
}

TEST(TileBook, ChangeThatIsTakenBackBeforeItWasSentIsStillSent) {
  Desk desk;
  desk.update(*test::make_snapshot(1, {{0, 0}, 32, 32}));
  desk.drain();
  desk.update(*test::make_snapshot(2, {{0, 0}, 32, 32}, 1));
  desk.update(*test::make_snapshot(3, {{0, 0}, 32, 32}, 0));  // tile_rev is 3 now: receivers wait for it
  EXPECT_EQ(desk.next().tile_rev, 3u);
  EXPECT_EQ(desk.drain(), kPublishedLayers.size());
}

TEST(TileBook, RollingWindowForgetsTilesAndSendsNewOnes) {
  Desk desk;
  desk.update(*test::make_snapshot(1, {{0, 0}, 64, 96}));
  desk.drain();
  desk.update(*test::make_snapshot(2, {{32, 0}, 64, 96}));
  EXPECT_EQ(desk.drain(), 2 * kPublishedLayers.size());  // the two tiles of column 3
  EXPECT_EQ(desk.queue.units(), 6 * kPublishedLayers.size());
  EXPECT_EQ(desk.queue.blocks(), 6 * (kPublishedLayers.size() + 1)) << "elevation takes two";
  EXPECT_EQ(desk.book.tile_rev(0, 0), 1u);
  desk.update(*test::make_snapshot(3, {{33, 0}, 64, 96}));
  // column 1 loses a row of cells, column 4 enters with one
  EXPECT_EQ(desk.drain(), 4 * kPublishedLayers.size());
  EXPECT_EQ(desk.book.handles(), 8 * kPublishedLayers.size()) << "places of tiles that left are used again";
  for (std::int32_t tx = 1; tx <= 4; ++tx) {
    const auto unit = desk.book.find({tx, 1}, Layer::dimension);
    ASSERT_TRUE(unit);
    EXPECT_EQ(desk.book.unit(*unit).tile, (TileIndex{tx, 1}));
    EXPECT_EQ(desk.book.unit(*unit).layer, Layer::dimension);
  }
  EXPECT_FALSE(desk.book.find({0, 1}, Layer::dimension));
  EXPECT_FALSE(desk.book.find({1, 1}, Layer::hits)) << "not published";
}

TEST(SendQueue, LeastRecentlySentGoesRound) {
  Desk desk;
  desk.update(*test::make_snapshot(1, {{0, 0}, 64, 64}));
  desk.drain();
  std::vector<UnitHandle> order;
  for (std::size_t i = 0; i < desk.queue.units(); ++i) {
    order.push_back(*desk.queue.least_recently_sent());
    desk.queue.mark_sent(order.back(), 0, {});
  }
  EXPECT_EQ(desk.queue.least_recently_sent(), order.front());
  std::sort(order.begin(), order.end());
  EXPECT_EQ(std::unique(order.begin(), order.end()), order.end());
}

// A plain model beside it: two vectors and linear search.
TEST(SendQueue, AgreesWithAPlainModelOverRandomOperations) {
  constexpr UnitHandle kHandles = 40;
  SendQueue queue;
  queue.reserve(kHandles);
  std::vector<UnitHandle> pending, sent;
  const auto has = [](const std::vector<UnitHandle>& list, UnitHandle h) {
    return std::find(list.begin(), list.end(), h) != list.end();
  };
  for (std::int32_t step = 0; step < 20'000; ++step) {
    const auto words = random_words(5, 0, step, 0);
    const UnitHandle handle = static_cast<UnitHandle>(words[0] % kHandles);
    switch (words[1] % 5) {
      case 0:
        queue.change(handle, 1, 0);
        std::erase(sent, handle);
        if (!has(pending, handle)) pending.push_back(handle);
        break;
      case 1:
        queue.remove(handle);
        std::erase(sent, handle);
        std::erase(pending, handle);
        break;
      case 2:
        EXPECT_EQ(queue.request(handle, 0), has(sent, handle));
        if (std::erase(sent, handle) > 0) pending.push_back(handle);
        break;
      default:
        for (auto* list : {&pending, &sent}) {
          if (list->empty() || (list == &sent) != (words[1] % 5 == 4)) continue;
          const UnitHandle first = list->front();
          queue.mark_sent(first, static_cast<int>(words[2] % 4), MonotonicTime{} + std::chrono::seconds(step));
          list->erase(list->begin());
          sent.push_back(first);
        }
    }
    ASSERT_EQ(queue.units(), pending.size() + sent.size());
    ASSERT_EQ(queue.blocks(), queue.units());
    ASSERT_EQ(queue.pending_blocks(), pending.size());
    ASSERT_EQ(queue.next_pending(), pending.empty() ? std::nullopt : std::optional(pending.front()));
    ASSERT_EQ(queue.least_recently_sent(), sent.empty() ? std::nullopt : std::optional(sent.front()));
  }
}

TEST(SendQueue, CopiesAreDueOneAfterTheOtherUntilTheContentChanges) {
  using namespace std::chrono_literals;
  const MonotonicTime start = MonotonicTime{} + 10s;
  SendQueue queue;
  queue.reserve(3);
  for (UnitHandle handle : {0u, 1u, 2u}) queue.change(handle, 1, 0);
  queue.mark_sent(0, 2, start + 20ms);
  queue.mark_sent(1, 1, start + 21ms);
  queue.mark_sent(2, 0, start + 22ms);
  EXPECT_FALSE(queue.next_repeat(start + 20ms - 1ns));
  EXPECT_EQ(queue.next_repeat(start + 20ms), 0u);
  queue.mark_repeated(0, start + 40ms);
  EXPECT_FALSE(queue.next_repeat(start + 20ms));
  EXPECT_EQ(queue.next_repeat(start + 60ms), 1u);
  queue.mark_repeated(1, start + 41ms);
  EXPECT_EQ(queue.next_repeat(start + 60ms), 0u);
  queue.change(0, 1, 1);
  EXPECT_FALSE(queue.next_repeat(start + 1h));
  EXPECT_FALSE(queue.repeat_due());
}

}  // namespace
}  // namespace scree::node
