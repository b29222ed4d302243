// The freshness rules, with a clock of the test's own.

#include "node/listener.hpp"

#include <gtest/gtest.h>

#include "node/listener_assembly.hpp"
#include "node/protocol.hpp"
#include "tests/node/golden.hpp"
#include "tests/node/maps.hpp"

namespace scree::node {
namespace {

using namespace std::chrono_literals;
using drivers::Origin;
using protocol::Layer;
using protocol::Reject;

/// A sender and a receiver on a clock that only moves when told.
struct Scene {
  MapAssembly assembly{{Origin::live}};
  MonotonicTime now = MonotonicTime{} + 1000s;
  protocol::Header header;
  std::uint64_t next_seq = 1;

  Scene() {
    header.boot_id = 11;
    header.stream_id = 7;
  }
  template <class Message>
  Reject send(const Message& message) {
    protocol::Datagram datagram;
    header.seq = next_seq++;
    protocol::encode(header, message, datagram);
    return assembly.accept(datagram.view(), now);
  }
  void wait(Duration duration) {
    now += duration;
    assembly.advance(now);
  }
  /// Time passes while heartbeats come.
  void wait_alive(Duration duration) {
    for (const MonotonicTime end = now + duration; now < end;) {
      wait(50ms);
      send(protocol::Heartbeat{});
    }
  }
  static protocol::Announce announcement() {
    protocol::Announce announce;
    announce.resolution_m = 0.1;
    announce.window = {{0, 0}, 32, 64};
    announce.frame_name = announce.node_name = announce.software_version = "x";
    return announce;
  }
  static protocol::TileBlock tile(std::int32_t tx, std::uint32_t rev, std::int16_t cost) {
    protocol::TileBlock block;
    block.tx = tx;
    block.tile_rev = rev;
    block.raw.fill(cost);
    return block;
  }
  static protocol::Manifest manifest(std::uint32_t rev0, std::uint32_t rev1) {
    protocol::Manifest message;
    message.columns = 2;
    message.rows = 1;
    message.tile_rev[0] = rev0;
    message.tile_rev[1] = rev1;
    return message;
  }
  /// A live map: tile 0 costs 10, tile 1 costs 20, both of revision 5.
  void start() {
    EXPECT_EQ(send(protocol::Heartbeat{}), Reject::none);
    EXPECT_EQ(send(announcement()), Reject::none);
    EXPECT_EQ(send(tile(0, 5, 10)), Reject::none);
    EXPECT_EQ(send(tile(1, 5, 20)), Reject::none);
  }
  int cost(int tx) { return assembly.map(now)->cost(0, 32 * tx); }
};

TEST(Freshness, WithoutHeartbeatStaleAt300msAndLostAt1s) {
  Scene scene;
  EXPECT_EQ(scene.assembly.link(), LinkState::waiting);
  scene.start();
  EXPECT_EQ(scene.assembly.link(), LinkState::fresh);
  scene.wait(299ms);
  EXPECT_EQ(scene.assembly.link(), LinkState::fresh);
  scene.wait(1ms);
  EXPECT_EQ(scene.assembly.link(), LinkState::stale);
  EXPECT_EQ(scene.cost(0), 10);
  scene.wait(699ms);
  EXPECT_EQ(scene.assembly.link(), LinkState::stale);
  EXPECT_EQ(scene.cost(0), 10);
  scene.wait(1ms);
  EXPECT_EQ(scene.assembly.link(), LinkState::lost);
  EXPECT_EQ(test::known_cells(*scene.assembly.map(scene.now)), 0u);
  EXPECT_EQ(scene.assembly.last_valid_map(scene.now)->cost(0, 0), 10);
}

TEST(Freshness, MapStaysUnknownAfterABlackoutUntilTilesComeAgain) {
  Scene scene;
  scene.start();
  scene.wait(1500ms);
  scene.send(protocol::Heartbeat{});
  EXPECT_EQ(scene.assembly.link(), LinkState::fresh);
  EXPECT_EQ(scene.cost(0), 255);
  scene.send(Scene::tile(0, 5, 10));
  EXPECT_EQ(scene.cost(0), 10);
}

TEST(Freshness, AnnouncedTimesShortenButNeverLengthen) {
  for (const auto& [stale_ms, lost_ms, stale, lost] :
       {std::tuple{100u, 200u, Duration(100ms), Duration(200ms)}, {5000u, 9000u, Duration(300ms), Duration(1000ms)}}) {
    Scene scene;
    scene.start();
    auto announce = Scene::announcement();
    announce.stale_ms = stale_ms;
    announce.lost_ms = lost_ms;
    scene.send(announce);
    scene.wait(stale);
    EXPECT_EQ(scene.assembly.link(), LinkState::stale);
    scene.wait(lost - stale);
    EXPECT_EQ(scene.assembly.link(), LinkState::lost);
  }
}

TEST(Freshness, FaultReadsUnknownWhileItLasts) {
  Scene scene;
  scene.start();
  scene.header.health = protocol::kHealthFault;
  scene.send(protocol::Heartbeat{});
  EXPECT_EQ(scene.assembly.link(), LinkState::lost);
  EXPECT_EQ(scene.cost(0), 255);
  EXPECT_EQ(scene.assembly.last_valid_map(scene.now)->cost(0, 0), 10);
  scene.header.health = 0;
  scene.send(protocol::Heartbeat{});
  EXPECT_EQ(scene.cost(0), 10);
}

TEST(Freshness, TilesFromBeforeAFaultDoNotComeBackAfterSilence) {
  Scene scene;
  scene.start();
  scene.header.health = protocol::kHealthFault;
  scene.send(protocol::Heartbeat{});
  scene.wait(1100ms);
  scene.header.health = 0;
  scene.send(protocol::Heartbeat{});
  EXPECT_EQ(scene.assembly.link(), LinkState::fresh);
  EXPECT_EQ(scene.cost(0), 255);
}

TEST(Freshness, ByeEndsTheMapAndKeepsTheLastOne) {
  Scene scene;
  scene.start();
  scene.send(protocol::Bye{protocol::ByeReason::stopped});
  EXPECT_TRUE(scene.assembly.ended());
  EXPECT_EQ(scene.assembly.bye_reason(), protocol::ByeReason::stopped);
  EXPECT_EQ(scene.assembly.link(), LinkState::lost);
  EXPECT_EQ(scene.cost(0), 255);
  EXPECT_EQ(scene.assembly.last_valid_map(scene.now)->cost(0, 40), 20);
  scene.send(protocol::Heartbeat{});  // of the same boot, overtaken by BYE
  EXPECT_EQ(scene.assembly.link(), LinkState::lost);
}

TEST(Freshness, NoCellOfAnEarlierBootSurvives) {
  Scene scene;
  scene.start();
  scene.header.boot_id = 12;
  scene.next_seq = 1;
  scene.send(Scene::announcement());
  EXPECT_EQ(scene.assembly.link(), LinkState::lost);
  scene.send(protocol::Heartbeat{});
  EXPECT_EQ(scene.assembly.link(), LinkState::fresh);
  EXPECT_EQ(test::known_cells(*scene.assembly.map(scene.now)), 0u);
  scene.send(Scene::tile(1, 1, 30));  // a lower revision counts in a new boot
  EXPECT_EQ(scene.cost(1), 30);
  EXPECT_EQ(scene.assembly.counters().lost, 0u);
}

TEST(Freshness, MalformedDatagramOfANewBootForgetsNothing) {
  Scene scene;
  scene.start();
  scene.header.boot_id = 12;
  auto bad = Scene::tile(0, 9, 1);
  bad.scale = -1.0f;
  EXPECT_EQ(scene.send(bad), Reject::body_value);
  EXPECT_EQ(scene.cost(0), 10);
}

TEST(Freshness, TwoSendersOnOneStreamAreAFault) {
  Scene scene;
  scene.start();
  scene.header.boot_id = 12;
  scene.start();
  EXPECT_EQ(scene.assembly.link(), LinkState::fresh);
  scene.header.boot_id = 11;  // late datagrams of the old boot within 1 s
  scene.wait(900ms);
  scene.header.boot_id = 12;
  scene.send(protocol::Heartbeat{});
  scene.header.boot_id = 11;
  EXPECT_EQ(scene.send(protocol::Heartbeat{}), Reject::old_boot);
  EXPECT_EQ(scene.assembly.link(), LinkState::fresh);
  scene.wait(200ms);
  EXPECT_EQ(scene.send(protocol::Heartbeat{}), Reject::old_boot);
  EXPECT_EQ(scene.assembly.link(), LinkState::lost);
  EXPECT_TRUE(scene.assembly.health() & protocol::kHealthFault);
  scene.header.boot_id = 12;
  scene.wait_alive(1000ms);
  EXPECT_EQ(scene.assembly.link(), LinkState::fresh);
  EXPECT_FALSE(scene.assembly.health() & protocol::kHealthFault);
}

TEST(Freshness, TileOlderThanItsManifestReadsUnknownAfterHalfASecond) {
  Scene scene;
  scene.start();
  scene.send(Scene::manifest(5, 6));
  scene.wait_alive(500ms);
  EXPECT_EQ(scene.cost(1), 20);
  scene.wait_alive(50ms);
  EXPECT_EQ(scene.cost(0), 10);
  EXPECT_EQ(scene.cost(1), 255);
  scene.send(Scene::tile(1, 5, 20));  // still the old one
  scene.wait_alive(50ms);
  EXPECT_EQ(scene.cost(1), 255);
  scene.send(Scene::tile(1, 6, 21));
  EXPECT_EQ(scene.cost(1), 21);
}

TEST(Freshness, BothHalvesMustHaveTheRevisionOfTheManifest) {
  Scene scene;
  scene.start();
  auto half = Scene::tile(0, 5, 100);
  half.layer = Layer::elevation;
  half.rows = 16;
  scene.send(half);
  half.row0 = 16;
  scene.send(half);
  auto manifest = Scene::manifest(6, 0);
  manifest.layer = static_cast<std::uint8_t>(Layer::elevation);
  scene.send(manifest);
  half.tile_rev = 6;
  scene.send(half);
  scene.wait_alive(600ms);
  EXPECT_TRUE(std::isnan(scene.assembly.map(scene.now)->elevation_m(0, 0)));
  half.row0 = 0;
  scene.send(half);
  EXPECT_EQ(scene.assembly.map(scene.now)->elevation_m(0, 0), 100.0f);
  EXPECT_EQ(scene.assembly.map(scene.now)->elevation_m(31, 0), 100.0f);
}

TEST(Freshness, BlockExpiresByItsOwnAgePlusTheTimeSinceItCame) {
  Scene scene;
  scene.start();
  auto announce = Scene::announcement();
  announce.cell_max_age_ms = 1000;
  scene.send(announce);
  auto old = Scene::tile(0, 5, 10);
  old.block_age_ms = 600;
  scene.send(old);
  scene.wait_alive(400ms);
  EXPECT_EQ(scene.cost(0), 10);
  scene.wait_alive(50ms);
  EXPECT_EQ(scene.cost(0), 255);
  EXPECT_EQ(scene.cost(1), 20);
  scene.wait_alive(600ms);
  EXPECT_EQ(scene.cost(1), 255);
}

TEST(Assembly, LowerTileRevisionNeverOverwritesAHigherOne) {
  Scene scene;
  scene.start();
  EXPECT_EQ(scene.send(Scene::tile(0, 4, 99)), Reject::none);
  EXPECT_EQ(scene.cost(0), 10);
  EXPECT_EQ(scene.assembly.counters().tiles_outdated, 1u);
}

TEST(Assembly, TilesOutsideTheWindowAreForgotten) {
  Scene scene;
  scene.start();
  scene.send(Scene::tile(2, 5, 30));
  EXPECT_EQ(scene.assembly.counters().tiles_outside, 1u);
  auto announce = Scene::announcement();
  announce.window = {{40, 0}, 32, 64};
  scene.send(announce);
  auto map = scene.assembly.map(scene.now);
  EXPECT_EQ(map->window.min.x, 40);
  EXPECT_EQ(map->cost(0, 0), 20);
  EXPECT_EQ(map->cost(0, 24), 255);
  scene.send(Scene::announcement());
  EXPECT_EQ(scene.cost(0), 255);
  EXPECT_EQ(scene.cost(1), 20);
}

TEST(Assembly, RefusesOriginsAndStreamsItWasNotAskedFor) {
  Scene scene;
  scene.header.origin = Origin::replay;
  EXPECT_EQ(scene.send(protocol::Heartbeat{}), Reject::origin);
  EXPECT_EQ(scene.assembly.refused_origin(), Origin::replay);
  EXPECT_EQ(scene.assembly.link(), LinkState::waiting);
  scene.header.origin = Origin::live;
  scene.start();
  scene.header.stream_id = 8;
  EXPECT_EQ(scene.send(protocol::Bye{}), Reject::stream);
  EXPECT_FALSE(scene.assembly.ended());
  EXPECT_EQ(scene.assembly.counters().refused_origin, 1u);
  EXPECT_EQ(scene.assembly.counters().rejected, 1u);
}

TEST(Assembly, CountsLossAndEveryReason) {
  Scene scene;
  scene.start();
  scene.next_seq += 3;
  scene.send(protocol::Heartbeat{});
  EXPECT_EQ(scene.assembly.counters().lost, 3u);
  scene.next_seq -= 2;
  scene.send(protocol::Heartbeat{});  // late
  EXPECT_EQ(scene.assembly.counters().lost, 2u);
  EXPECT_EQ(scene.send(protocol::Heartbeat{}), Reject::sequence);  // a duplicate
  EXPECT_EQ(scene.assembly.accept({}, scene.now), Reject::too_short);
  EXPECT_EQ(scene.assembly.accept(test::golden("heartbeat_mac"), scene.now), Reject::mac);
  const ListenerCounters& counters = scene.assembly.counters();
  EXPECT_EQ(counters.rejected, 3u);
  EXPECT_EQ(counters.rejected_by[static_cast<std::size_t>(Reject::sequence)], 1u);
  EXPECT_EQ(counters.datagrams, counters.accepted + counters.rejected + counters.refused_origin + counters.ignored);
}

// 100,000 datagrams with 1 … 8 random bits flipped, cut or lengthened. CRC-32 finds every burst up to 32 bits; a
// random larger error passes with 2^-32, so a false alarm has probability below 3e-5.
TEST(Assembly, MalformedDatagramsNeverChangeTheMap) {
  Scene scene;
  scene.start();
  std::vector<protocol::Datagram> good(5);
  scene.header.seq = scene.next_seq;
  auto worst = Scene::tile(0, 1000, 77);
  for (std::size_t i = 0; i < worst.raw.size(); ++i) worst.raw[i] = static_cast<std::int16_t>(i % 251);
  protocol::encode(scene.header, worst, good[0]);
  auto elsewhere = Scene::announcement();
  elsewhere.window.min.x = 320;
  protocol::encode(scene.header, elsewhere, good[1]);
  protocol::encode(scene.header, Scene::manifest(2000, 2000), good[2]);
  protocol::encode(scene.header, protocol::Bye{}, good[3]);
  scene.header.boot_id = 99;
  protocol::encode(scene.header, protocol::Heartbeat{}, good[4]);
  for (std::int32_t i = 0; i < 100'000; ++i) {
    const auto words = random_words(5, 1, i, 0);
    const protocol::Datagram& datagram = good[words[0] % good.size()];
    std::vector<std::uint8_t> bytes(datagram.view().begin(), datagram.view().end());
    if (words[0] >> 16 & 1) bytes.resize(words[1] % 1300);
    for (std::uint32_t flip = 0; flip <= words[2] % 8 && !bytes.empty(); ++flip) {
      const auto place = random_words(5, 2, i, static_cast<std::int32_t>(flip));
      bytes[place[0] % bytes.size()] ^= static_cast<std::uint8_t>(1u << place[1] % 8);
    }
    if (std::equal(bytes.begin(), bytes.end(), datagram.view().begin(), datagram.view().end())) continue;
    ASSERT_NE(scene.assembly.accept(bytes, scene.now), Reject::none);
  }
  EXPECT_EQ(scene.assembly.link(), LinkState::fresh);
  EXPECT_EQ(scene.cost(0), 10);
  EXPECT_EQ(scene.cost(1), 20);
  scene.header.boot_id = 11;
  scene.wait_alive(600ms);  // no manifest slipped through either
  EXPECT_EQ(scene.cost(1), 20);
}

TEST(Listener, OccupiedPortIsUnavailableAndSaysSo) {
  const auto first = Listener::open("127.0.0.1:0", {Origin::live});
  ASSERT_TRUE(first) << first.error().message;
  const std::string address = "127.0.0.1:" + std::to_string((*first)->port());
  const auto second = Listener::open(address, {Origin::live});
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().kind, ErrorKind::unavailable);
  EXPECT_EQ(second.error().message, "listen address " + address + ": expected a free UDP port, found it in use");
}

TEST(Listener, AddressMustBeOneAddressWithAPort) {
  for (const char* address : {"", "127.0.0.1", "127.0.0.1:", "127.0.0.1:65536", "example.org:1", "0.0.0.0:47800",
                              "[::]:47800", "127.0.0.1:-1", "1.2.3:4"}) {
    const auto listener = Listener::open(address, {Origin::live});
    ASSERT_FALSE(listener) << address;
    EXPECT_EQ(listener.error().kind, ErrorKind::usage) << address;
  }
}

}  // namespace
}  // namespace scree::node
