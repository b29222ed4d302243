// A publisher and a client that asks again, with a way between them that loses a third of everything: on a clock of the
// test's own, with seeded draws, so that it either fails always or never.

#include <deque>
#include <gtest/gtest.h>
#include <map>
#include <tuple>
#include <vector>

#include "node/inbox.hpp"
#include "node/listener_client.hpp"
#include "tests/node/maps.hpp"
#include "tests/node/publishing.hpp"

namespace scree::node {
namespace {

using namespace std::chrono_literals;
using drivers::Origin;

constexpr LatticeWindow kSmall{{0, 0}, 160, 160};  // 5 × 5 tiles

/// Delays by 2.5 ms and loses `loss`, both ways.
struct BadWay {
  struct Item {
    MonotonicTime at;
    std::vector<std::uint8_t> bytes;
  };
  std::deque<Item> items;
  double loss;
  std::int32_t drawn = 0;
  std::uint64_t stream;

  BadWay(double loss_share, std::uint64_t seed) : loss(loss_share), stream(seed) {}
  void put(std::span<const std::uint8_t> bytes, MonotonicTime now) {
    if (to_uniform(random_words(17, stream, drawn++, 0)[0]) < loss) return;
    items.push_back({now + 2500us, {bytes.begin(), bytes.end()}});
  }
  template <class Take>
  void deliver(MonotonicTime now, Take take) {
    for (; !items.empty() && items.front().at <= now; items.pop_front()) take(items.front().bytes);
  }
};

struct Scene {
  test::Tap client_socket;
  std::unique_ptr<Inbox> inbox = *Inbox::open("127.0.0.1:0", "", 1);
  std::unique_ptr<Publisher> publisher;
  RequestQueue queue;
  RequestReader reader{1, {}};
  MapAssembly assembly{{Origin::live}};
  NodeClient client;
  BadWay down, up;
  Endpoint endpoint;
  MonotonicTime now = MonotonicClock::now();
  /// Newest revision of each block that arrived.
  std::map<std::tuple<int, int, int, int>, std::uint32_t> held;

  Scene(double loss, std::uint64_t layers, int repeats)
      : client({0, layers, {}, 0, static_cast<std::uint8_t>(repeats)}, 1, 77, {}), down(loss, 1), up(loss, 2) {
    auto settings = test::settings_for(9);  // discards
    settings.refresh_ms = 1000;
    publisher = *Publisher::open(settings, Origin::live, 0.1, 0, inbox->socket());
    endpoint = *parse_endpoint("127.0.0.1:" + std::to_string(client_socket.socket.local_port()), "test");
  }
  void note(std::span<const std::uint8_t> bytes) {
    protocol::Opened opened;
    protocol::TileBlock block;
    if (protocol::open_datagram(bytes, opened) != protocol::Reject::none) return;
    if (opened.header.type != protocol::MessageType::tile || decode(opened, block) != protocol::Reject::none) return;
    auto& rev = held[{block.tx, block.ty, static_cast<int>(block.layer), block.row0}];
    rev = std::max(rev, block.tile_rev);
  }
  void step() {
    now += 2500us;
    up.deliver(now, [&](std::span<const std::uint8_t> bytes) {
      Request request;
      if (reader.read(bytes, endpoint, request) == protocol::Reject::none) publisher->handle(request, now);
    });
    publisher->tick(now, test::status());
    client_socket.drain([&](std::span<const std::uint8_t> bytes) { down.put(bytes, now); });
    down.deliver(now, [&](std::span<const std::uint8_t> bytes) {
      assembly.accept(bytes, now);
      note(bytes);
    });
    assembly.advance(now);
    client.tick(now, Time{}, assembly, [&](std::span<const std::uint8_t> bytes) { up.put(bytes, now); });
  }
  void run(Duration duration) {
    for (const auto end = now + duration; now < end;) step();
  }
};

/// Share of the blocks that changed and were not current 1 s later; a map at 10 Hz, all of it changing every 2 s.
double late_share(Scene& scene, int maps) {
  std::vector<std::pair<MonotonicTime, std::uint32_t>> due;
  std::uint64_t late = 0, judged = 0;
  std::size_t next = 0;
  for (int i = 0; i < maps + 10; ++i) {
    if (i < maps) {
      const auto revision = static_cast<std::uint32_t>(i + 1);
      scene.publisher->submit(test::make_snapshot(revision, kSmall, static_cast<std::uint64_t>(i / 20)));
      if (i % 20 == 0) due.emplace_back(scene.now + 1s, revision);
    }
    scene.run(100ms);
    if (next == due.size() || scene.now < due[next].first) continue;
    const std::uint32_t revision = due[next++].second;
    for (const protocol::Layer layer : {protocol::Layer::cost, protocol::Layer::elevation})
      for (int tile = 0; tile < 25; ++tile)
        for (int half = 0; half < block_count(layer); ++half) {
          ++judged;
          late += scene.held[{tile % 5, tile / 5, static_cast<int>(layer), 16 * half}] >= revision ? 0 : 1;
        }
  }
  EXPECT_GE(judged, 75u * static_cast<unsigned>(maps / 20));
  return static_cast<double>(late) / static_cast<double>(judged);
}

constexpr std::uint64_t kTwoLayers = 3;  // cost and elevation

// 75 blocks in each of 100 changes. A block is late when it and all of some nine answers to NACKs and one refresh are
// lost; the share allowed is the one that the planner's side is to have.
TEST(Nack, BlocksAreCurrentWithinASecondAtThirtyPercentLoss) {
  Scene scene(0.3, kTwoLayers, 0);
  scene.publisher->submit(test::make_snapshot(1, kSmall));
  scene.run(3s);  // subscribed by now: the first attempts may be lost
  EXPECT_LE(late_share(scene, 2000), 0.001);
  EXPECT_GT(scene.client.counters().nacks, 100u);
  EXPECT_NE(scene.assembly.link(), LinkState::lost);
  EXPECT_EQ(scene.publisher->subscriptions().lease_expired, 0u) << "NACKs renew the lease too";
}

TEST(Nack, WithoutLossAlmostNothingIsAskedForAndTheMapIsRight) {
  Scene scene(0.0, kTwoLayers, 0);
  scene.publisher->submit(test::make_snapshot(1, kSmall));
  scene.run(1s);
  EXPECT_EQ(late_share(scene, 100), 0.0);
  EXPECT_EQ(scene.publisher->subscriptions().tiles_requeued, 0u);
  const auto map = scene.assembly.map(scene.now);
  const auto expected = test::quantised(*test::make_snapshot(100, kSmall, 99 / 20));
  ASSERT_TRUE(map);
  for (std::size_t i = 0; i < map->cost.size(); ++i) {
    ASSERT_EQ(map->cost[i], expected->cost[i]);
    ASSERT_TRUE(test::same_float(map->elevation_m[i], expected->elevation_m[i]));
  }
}

TEST(Nack, AfterAllIsQuietTheMapIsRightAtThirtyPercentLoss) {
  Scene scene(0.3, kTwoLayers, 1);
  (void)late_share(scene, 60);
  scene.run(5s);
  const auto map = scene.assembly.map(scene.now);
  const auto expected = test::quantised(*test::make_snapshot(60, kSmall, 59 / 20));
  ASSERT_TRUE(map);
  for (std::size_t i = 0; i < map->cost.size(); ++i) {
    ASSERT_EQ(map->cost[i], expected->cost[i]);
    ASSERT_TRUE(test::same_float(map->elevation_m[i], expected->elevation_m[i]));
  }
  EXPECT_GT(scene.publisher->counters().blocks_repeated, 100u);
}

TEST(Nack, ClientMeasuresRoundTripAndClockOffset) {
  Scene scene(0.0, kTwoLayers, 0);
  scene.run(2s);
  ASSERT_TRUE(scene.client.counters().round_trip);
  EXPECT_GE(*scene.client.counters().round_trip, 5ms);
  EXPECT_LE(*scene.client.counters().round_trip, 10ms) << "two ways of 2.5 ms and the steps of the test";
}

}  // namespace
}  // namespace scree::node
