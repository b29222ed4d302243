// The publisher over real loopback sockets, on ports that the kernel chooses.

#include "node/publisher.hpp"

#include <gtest/gtest.h>
#include <map>
#include <thread>
#include <tuple>

#include "config/loader.hpp"
#include "node/listener_assembly.hpp"
#include "node/protocol.hpp"
#include "tests/node/maps.hpp"
#include "tests/node/publishing.hpp"

namespace scree::node {
namespace {

using namespace std::chrono_literals;
using drivers::Origin;
using protocol::MessageType;
using test::kWindow;
using test::open_listener;
using test::open_publisher;
using test::settings_for;
using test::status;
using test::Tap;

/// Ticks and polls in turn until `done` or 5 s.
template <class Done>
bool run_until(Publisher& publisher, Listener& listener, Done done) {
  for (const auto end = MonotonicClock::now() + 5s; MonotonicClock::now() < end;) {
    publisher.tick(MonotonicClock::now(), status());
    EXPECT_TRUE(listener.poll(1ms));
    if (done()) return true;
  }
  return false;
}

bool holds(const Listener& listener, const mapping::MapSnapshot& expected) {
  const auto map = listener.map();
  return map && map->window == expected.window && test::differing_cells(*map, expected) == 0;
}

/// finish() blocks, so the listener needs the other thread.
void finish(Publisher& publisher, Listener& listener) {
  std::jthread sender([&] {
    const Status done = publisher.finish(status());
    EXPECT_TRUE(done) << done.error().message;
  });
  for (const auto end = MonotonicClock::now() + 5s; !listener.ended() && MonotonicClock::now() < end;)
    EXPECT_TRUE(listener.poll(5ms));
  EXPECT_TRUE(listener.ended());
}

TEST(PublisherToListener, RoundTripEqualsTheQuantisedSnapshot) {
  const auto listener = open_listener();
  const auto publisher = open_publisher(settings_for(listener->port()));
  const auto map = test::make_snapshot(3, kWindow);
  publisher->submit(map);
  const auto expected = test::quantised(*map);
  ASSERT_TRUE(run_until(*publisher, *listener, [&] { return holds(*listener, *expected); }));
  const auto received = listener->map();
  EXPECT_EQ(received->revision, 3u);
  EXPECT_EQ(received->cell_m, 0.1);
  EXPECT_EQ(received->data_time, map->data_time);
  // the age went over the wire in microseconds, and the way took less than the test
  EXPECT_GE(received->received, map->received - 1us);
  EXPECT_LT(received->received, MonotonicClock::now());
  EXPECT_EQ(listener->link(), LinkState::fresh);
  EXPECT_EQ(listener->origin(), Origin::live);
  EXPECT_EQ(listener->frames_in(), 12u);
  EXPECT_EQ(listener->counters().rejected, 0u);
  EXPECT_EQ(listener->counters().lost, 0u);
  for (std::size_t i = 0; i < map->cost.size(); ++i) {  // independent of the quantiser: D to half of 1/254
    ASSERT_EQ(std::isnan(received->dimension[i]), std::isnan(map->dimension[i]));
    if (std::isnan(map->dimension[i])) continue;
    ASSERT_NEAR(received->dimension[i], map->dimension[i], 0.5 / 254 + 1e-6);
    ASSERT_NEAR(received->elevation_m[i], map->elevation_m[i], 0x1p-13 + 1e-6);
    ASSERT_NEAR(received->amplitude_m[i], map->amplitude_m[i], 0x1p-10 + 1e-6);
  }
}

TEST(PublisherToListener, FinishSendsTheWholeLastMapBeforeBye) {
  const auto listener = open_listener();
  const auto publisher = open_publisher(settings_for(listener->port()));
  publisher->submit(test::make_snapshot(1, kWindow, 1));
  publisher->tick(MonotonicClock::now(), status());
  const auto last = test::make_snapshot(2, {{-40, 20}, 130, 200}, 2);  // and the window rolled meanwhile
  publisher->submit(last);
  finish(*publisher, *listener);
  EXPECT_EQ(listener->link(), LinkState::lost);
  EXPECT_EQ(listener->bye_reason(), protocol::ByeReason::finished);
  EXPECT_EQ(test::known_cells(*listener->map()), 0u);
  ASSERT_TRUE(listener->last_valid_map());
  EXPECT_EQ(test::differing_cells(*listener->last_valid_map(), *test::quantised(*last)), 0u);
  EXPECT_EQ(publisher->counters().snapshots_superseded, 1u);
}

TEST(PublisherToListener, LateJoinerGetsTheWholeMapByRefresh) {
  std::uint16_t port = 0;
  port = open_listener()->port();  // closed again at once: nobody listens there
  const auto publisher = open_publisher(settings_for(port));
  const auto map = test::make_snapshot(1, kWindow);
  publisher->submit(map);
  for (const auto end = MonotonicClock::now() + 300ms; MonotonicClock::now() < end;) {
    publisher->tick(MonotonicClock::now(), status());
    std::this_thread::sleep_for(1ms);
  }
  EXPECT_EQ(publisher->counters().send_errors, 0u);  // ECONNREFUSED is not one
  const auto listener = open_listener(port);
  const auto expected = test::quantised(*map);
  EXPECT_TRUE(run_until(*publisher, *listener, [&] { return holds(*listener, *expected); }));
  EXPECT_EQ(listener->counters().rejected, 0u);
}

TEST(PublisherToListener, ChangesArriveAndRolledOutTilesAreForgotten) {
  const auto listener = open_listener();
  const auto publisher = open_publisher(settings_for(listener->port()));
  for (std::uint32_t revision = 1; revision <= 20; ++revision) {
    const LatticeWindow window{{static_cast<std::int32_t>(-7 * static_cast<int>(revision)), 13}, 130, 200};
    const auto map = test::make_snapshot(revision, window, revision / 3);
    publisher->submit(map);
    if (revision % 4 != 0) continue;  // the others are superseded unsent
    const auto expected = test::quantised(*map);
    ASSERT_TRUE(run_until(*publisher, *listener, [&] { return holds(*listener, *expected); })) << revision;
  }
  EXPECT_EQ(listener->counters().lost, 0u);
}

TEST(PublisherToListener, RestartedNodeLeavesNoCellOfItsOldMap) {
  const auto listener = open_listener();
  auto publisher = open_publisher(settings_for(listener->port()));
  const auto old_map = test::quantised(*test::make_snapshot(9, kWindow, 1));
  publisher->submit(old_map);
  ASSERT_TRUE(run_until(*publisher, *listener, [&] {
    return test::known_cells(*old_map) > 0 && listener->map() != nullptr && test::known_cells(*listener->map()) > 0;
  }));
  const std::uint64_t old_boot = publisher->boot_id();
  publisher.reset();  // killed: no BYE
  publisher = open_publisher(settings_for(listener->port()));
  EXPECT_NE(publisher->boot_id(), old_boot);
  auto empty = test::make_snapshot(1, kWindow);
  empty->cost.assign(kWindow.rows, kWindow.columns, 255);
  empty->state.assign(kWindow.rows, kWindow.columns, CellState::never_seen);
  for (auto* grid : {&empty->elevation_m, &empty->dimension, &empty->amplitude_m})
    grid->assign(kWindow.rows, kWindow.columns, std::numeric_limits<float>::quiet_NaN());
  publisher->submit(empty);
  ASSERT_TRUE(run_until(*publisher, *listener, [&] {
    return listener->link() == LinkState::fresh && listener->map() && listener->map()->revision == 1;
  }));
  EXPECT_EQ(test::known_cells(*listener->map()), 0u);
}

// 30 % loss, independent, 8 s on the test's own clock. Tiles count from the first ANNOUNCE (one a second) that comes
// through: not among the first five with probability 2e-3. From then on there are 15 cycles of 200 ms for 280 blocks:
// one is still missing with probability 280 · 0.3^15 = 4e-6. The draws are seeded: it either fails always or never.
TEST(PublisherToListener, RandomLossIsRepairedByRefreshAndNoCellIsEverWrong) {
  Tap tap;
  const auto publisher = open_publisher(settings_for(tap.socket.local_port()));
  const auto map = test::make_snapshot(1, kWindow);
  const auto expected = test::quantised(*map);
  publisher->submit(map);
  MapAssembly assembly({Origin::live});
  MonotonicTime now = map->received;
  std::int32_t count = 0;
  std::uint64_t dropped = 0;
  for (int step = 0; step < 8 * 200; ++step) {
    now += 5ms;
    publisher->tick(now, status());
    tap.drain([&](std::span<const std::uint8_t> bytes) {
      if (to_uniform(random_words(3, 0, count++, 0)[0]) < 0.3)
        ++dropped;
      else
        assembly.accept(bytes, now);
    });
    if (step % 40 != 0 || !assembly.map(now)) continue;
    const auto received = assembly.map(now);
    for (std::size_t i = 0; i < received->cost.size(); ++i)
      ASSERT_TRUE(received->cost[i] == 255 || received->cost[i] == expected->cost[i]);
  }
  ASSERT_TRUE(assembly.map(now));
  EXPECT_EQ(test::differing_cells(*assembly.map(now), *expected), 0u);
  EXPECT_GT(dropped, 100u);
  EXPECT_LE(assembly.counters().lost, dropped);  // the last ones may not show as gaps yet
  EXPECT_GE(assembly.counters().lost + 40, dropped);
}

TEST(Publisher, EveryBlockIsSentOncePerRefreshPeriodAndDatagramsAreNumbered) {
  Tap tap;
  auto settings = settings_for(tap.socket.local_port());
  settings.refresh_ms = 500;
  const auto publisher = open_publisher(settings);
  const auto map = test::make_snapshot(7, kWindow);
  publisher->submit(map);
  MonotonicTime now = map->received + 40ms;
  std::map<std::tuple<int, int, int, int>, MonotonicTime> last_sent;
  std::map<MessageType, int> of_type;
  std::uint64_t seq = 0;
  Duration longest_gap{0};
  for (int step = 0; step < 600; ++step) {  // 3 s
    now += 5ms;
    publisher->tick(now, status());
    tap.drain([&](std::span<const std::uint8_t> bytes) {
      protocol::Opened opened;
      ASSERT_EQ(protocol::open_datagram(bytes, opened), protocol::Reject::none);
      ASSERT_EQ(opened.header.seq, ++seq);
      ASSERT_EQ(opened.header.boot_id, publisher->boot_id());
      EXPECT_EQ(opened.header.config_hash, 0x01020304u);
      ++of_type[opened.header.type];
      if (opened.header.map_rev != 0) {
        EXPECT_EQ(opened.header.age_us,
                  std::chrono::duration_cast<std::chrono::microseconds>(now - map->received).count());
        EXPECT_EQ(opened.header.t_data_ns, map->data_time.time_since_epoch().count());
      }
      if (opened.header.type != MessageType::tile) return;
      protocol::TileBlock block;
      ASSERT_EQ(decode(opened, block), protocol::Reject::none);
      EXPECT_EQ(block.tile_rev, 7u);
      EXPECT_EQ(block.block_age_ms, opened.header.age_us / 1000);
      const auto [place, first] =
          last_sent.try_emplace({block.tx, block.ty, static_cast<int>(block.layer), block.row0}, now);
      EXPECT_EQ((opened.header.flags & protocol::kFlagRefresh) != 0, !first);
      longest_gap = std::max<Duration>(longest_gap, now - place->second);
      place->second = now;
    });
  }
  EXPECT_EQ(last_sent.size(), 8u * 5u * 7u);
  EXPECT_LE(longest_gap, 510ms);
  EXPECT_NEAR(of_type[MessageType::heartbeat], 30, 1);
  EXPECT_NEAR(of_type[MessageType::announce], 3 + 2, 1);  // with the copies of the first one
  EXPECT_NEAR(of_type[MessageType::manifest], 6 * 30, 12);
  // first sending, then about six cycles: the refresh is spread, not doubled
  EXPECT_NEAR(of_type[MessageType::tile], 280 + 6 * 280, 70);
}

TEST(Publisher, KeepsToItsPacing) {
  Tap tap;
  auto settings = settings_for(tap.socket.local_port());
  settings.datagrams_per_s = 500;
  const auto publisher = open_publisher(settings);
  MonotonicTime now = MonotonicClock::now();
  std::map<std::int64_t, int> per_100ms;
  const MonotonicTime begin = now;
  for (int step = 0; step < 400; ++step) {  // 2 s, everything changes at 20 Hz
    if (step % 10 == 0)
      publisher->submit(
          test::make_snapshot(static_cast<std::uint32_t>(step + 1), kWindow, static_cast<std::uint64_t>(step)));
    now += 5ms;
    publisher->tick(now, status());
    tap.drain([&](std::span<const std::uint8_t>) { ++per_100ms[(now - begin) / 100ms]; });
  }
  int total = 0;
  for (const auto& [interval, count] : per_100ms) {
    total += count;
    EXPECT_LE(count, 50 + 10 + 5) << interval;  // the rate, a full bucket, one overdraft for a set of manifests
  }
  EXPECT_NEAR(total, 1000, 40);
}

// 1200 cells, 7 manifests for each of 5 layers. Every 100 ms they would be 350 datagrams/s, more than there are.
TEST(Publisher, ManifestsLeaveThreeQuartersOfThePacingToOthers) {
  Tap tap;
  auto settings = settings_for(tap.socket.local_port());
  settings.datagrams_per_s = 300;
  const auto publisher = open_publisher(settings);
  publisher->submit(test::make_snapshot(1, {{-600, -600}, 1200, 1200}));
  MonotonicTime now = MonotonicClock::now();
  for (int step = 0; step < 800; ++step) {  // 4 s
    now += 5ms;
    publisher->tick(now, status());
    tap.drain([](std::span<const std::uint8_t>) {});
  }
  EXPECT_NEAR(static_cast<double>(publisher->counters().datagrams), 1200.0, 60.0);
  EXPECT_GT(publisher->counters().blocks, 0.6 * 1200);
}

TEST(Publisher, TakesTheLargestConfigurableMapWhereverItLies) {
  constexpr int kCells = 2048;
  ASSERT_TRUE(config::parse_settings("map: {size_cells: 2048}\n", "test.yaml", {}));
  ASSERT_FALSE(config::parse_settings("map: {size_cells: 2049}\n", "test.yaml", {}));
  for (std::int32_t x = 0; x < 32; ++x)
    for (std::int32_t y = 0; y < 32; ++y)
      ASSERT_LE(tiles_touched({{x, y}, kCells, kCells}).tiles(), protocol::kMaxWindowTiles) << x << ", " << y;
  Tap tap;
  const auto publisher = open_publisher(settings_for(tap.socket.local_port()));
  const auto map = test::make_snapshot(1, {{31, 31}, kCells, kCells});  // 65 × 65 tiles
  publisher->submit(map);
  EXPECT_EQ(publisher->counters().snapshots_refused, 0u);
  publisher->tick(map->received, status());
  MapAssembly assembly({Origin::live});
  tap.drain([&](std::span<const std::uint8_t> bytes) { assembly.accept(bytes, map->received); });
  ASSERT_TRUE(assembly.announce());
  EXPECT_EQ(assembly.announce()->window, map->window);
  EXPECT_EQ(assembly.counters().rejected, 0u);
  EXPECT_GT(publisher->counters().blocks, 0u);
}

// Blocks leave at 500 a second, so the last of 280 leaves after about half a second.
TEST(Publisher, LatencyIsFromFrameInToTheLastBlockOfItsMapOut) {
  Tap tap;
  auto settings = settings_for(tap.socket.local_port());
  settings.datagrams_per_s = 500;
  settings.refresh_ms = 60'000;
  const auto publisher = open_publisher(settings);
  MonotonicTime now = MonotonicClock::now();
  const MonotonicTime taken = now - 20ms;
  publisher->submit(test::make_snapshot(1, kWindow), taken);
  protocol::Heartbeat heartbeat;
  MonotonicTime last_block;
  for (int step = 0; step < 300; ++step) {
    now += 5ms;
    publisher->tick(now, status());
    tap.drain([&](std::span<const std::uint8_t> bytes) {
      protocol::Opened opened;
      ASSERT_EQ(protocol::open_datagram(bytes, opened), protocol::Reject::none);
      if (opened.header.type == MessageType::heartbeat) {
        ASSERT_EQ(decode(opened, heartbeat), protocol::Reject::none);
      }
      if (opened.header.type == MessageType::tile && (opened.header.flags & protocol::kFlagRefresh) == 0)
        last_block = now;
    });
    if (publisher->counters().blocks - publisher->counters().blocks_refreshed < 280) {
      EXPECT_EQ(publisher->latency().count(), 0u);
    }
  }
  ASSERT_EQ(publisher->counters().blocks - publisher->counters().blocks_refreshed, 280u);
  ASSERT_EQ(publisher->latency().count(), 1u);
  EXPECT_EQ(publisher->latency().max(), last_block - taken);
  EXPECT_GT(last_block - taken, 400ms);
  EXPECT_EQ(heartbeat.latency_max_us,
            std::chrono::duration_cast<std::chrono::microseconds>(last_block - taken).count());
}

TEST(Publisher, HeartbeatsComeBeforeTheFirstMap) {
  Tap tap;
  const auto publisher = open_publisher(settings_for(tap.socket.local_port()));
  MonotonicTime now = MonotonicClock::now();
  int heartbeats = 0;
  for (int step = 0; step <= 100; ++step, now += 10ms) {
    publisher->tick(now, status());
    tap.drain([&](std::span<const std::uint8_t> bytes) {
      protocol::Opened opened;
      ASSERT_EQ(protocol::open_datagram(bytes, opened), protocol::Reject::none);
      EXPECT_EQ(opened.header.type, MessageType::heartbeat);
      EXPECT_EQ(opened.header.age_us, 0xFFFFFFFFu);
      ++heartbeats;
    });
  }
  EXPECT_EQ(heartbeats, 11);
}

TEST(Publisher, SettingsThatCannotWorkAreRefusedByName) {
  config::PublishSettings settings;
  const auto error = [&] {
    const auto publisher = Publisher::open(settings, Origin::live, 0.1, 0);
    EXPECT_FALSE(publisher);
    return publisher ? Error{} : publisher.error();
  };
  settings.destination = "nowhere";
  EXPECT_EQ(error().kind, ErrorKind::usage);
  EXPECT_NE(error().message.find("publish.destination: expected ADDRESS:PORT"), std::string::npos) << error().message;
  settings.destination = "127.0.0.1:0";
  EXPECT_EQ(error().kind, ErrorKind::usage);
  settings.destination = "127.0.0.1:47800";
  settings.frame_name = std::string(32, 'x');
  EXPECT_EQ(error().kind, ErrorKind::bad_config);
}

TEST(Publisher, RefusesSnapshotsThatContradictTheAnnouncement) {
  Tap tap;
  const auto publisher = open_publisher(settings_for(tap.socket.local_port()));
  auto map = test::make_snapshot(1, kWindow);
  map->cell_m = 0.2;
  publisher->submit(map);
  publisher->submit(test::make_snapshot(1, {{0, 0}, 0, 0}));
  EXPECT_EQ(publisher->counters().snapshots_refused, 2u);
}

}  // namespace
}  // namespace scree::node
