// The C++ client's own parts: hash, checksum, memory, configuration, socket.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <malloc.h>
#include <thread>

#include "client/scree_client.hpp"
#include "tests/client/allocation_counter.hpp"
#include "tests/client/client_socket.hpp"
#include "tests/client/scenario.hpp"
#include "tests/support/map_sender.hpp"

namespace scree::test {
namespace {

using client::Clock;
using client::Config;
using client::Verdict;
using std::chrono::milliseconds;
using testing::HasSubstr;

TEST(Blake2b, AgreesWithRfc7693AndHashlib) {
  const auto lines = read_scenario(golden_folder() / "blake2b.txt");
  ASSERT_GT(lines.size(), 50U);
  for (const ScenarioLine& line : lines) {
    const auto key = from_hex(line.words[0] == "-" ? "" : line.words[0]);
    const auto data = from_hex(line.words[1] == "-" ? "" : line.words[1]);
    const auto expected = from_hex(line.words[2]);
    std::vector<std::uint8_t> out(expected.size());
    client::detail::blake2b(out.data(), out.size(), key.data(), key.size(), data.data(), data.size());
    EXPECT_EQ(out, expected) << "line " << line.number;
  }
}

TEST(Crc32, IsZlibs) {
  const std::string check = "123456789";
  EXPECT_EQ(client::detail::crc32(0, reinterpret_cast<const std::uint8_t*>(check.data()), check.size()), 0xCBF43926U);
  std::vector<std::uint8_t> bytes(1200);
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::uint8_t>(i * i + 3 * i);
  for (std::size_t size = 64; size <= bytes.size(); ++size)
    ASSERT_EQ(client::detail::datagram_crc(bytes.data(), size),
              node::protocol::datagram_crc(std::span(bytes).first(size)));
}

TEST(Memory, NothingIsAllocatedAfterOpen) {
  Config config;
  config.bind = "127.0.0.1:0";
  config.node = "127.0.0.1:9";
  const auto map = std::make_unique<client::Client>();
  ASSERT_TRUE(map->open(config)) << map->error();
  MapSender sender({});
  std::vector<std::vector<std::uint8_t>> datagrams;
  for (int ms = 0; ms < 2000; ms += 5)
    sender.tick(milliseconds(ms), [&](auto bytes) { datagrams.emplace_back(bytes.begin(), bytes.end()); });
  const auto cookie = golden_vector("cookie");
  std::vector<std::uint8_t> cost(200 * 200);
  std::vector<std::int8_t> occupancy(cost.size());
  std::vector<float> elevation(cost.size());
  const Sender to(map->port());
  std::size_t known = 0;

  const std::uint64_t before = allocation_count();
  const std::size_t bytes_before = mallinfo2().uordblks;
  for (std::size_t i = 0; i < datagrams.size(); ++i) {
    if (i % 3 != 0) (void)to.send(datagrams[i]);  // losses: NACKs are due
    if (i % 16 == 0) map->poll();
    if (i % 64 != 0) continue;
    (void)map->copy_cost(cost.data(), cost.size());
    (void)map->to_occupancy(occupancy.data(), occupancy.size());
    (void)map->copy_layer(client::Layer::elevation, elevation.data(), elevation.size());
    known += map->cost(0.0, 3.0) != client::kCostUnknown;
  }
  EXPECT_EQ(allocation_count(), before);
  EXPECT_EQ(mallinfo2().uordblks, bytes_before);
  EXPECT_GT(map->counters().tiles, 100U);
  EXPECT_GT(known, 0U);
  EXPECT_GE(map->memory_bytes(), 1024U * (5 * 1024 + 2048));
}

void expect_refused(const Config& config, const char* what) {
  client::Client map;
  EXPECT_FALSE(map.open(config));
  EXPECT_THAT(map.error(), HasSubstr(what));
  EXPECT_EQ(map.fd(), -1);
}

TEST(Configuration, WhatCannotBeIsRefusedByName) {
  const auto with = [](auto change) {
    Config config;
    config.bind = "127.0.0.1:0";
    change(config);
    return config;
  };
  for (const char* bind : {"0.0.0.0:47800", "[::]:47800", "0.0.0.0:0"})
    expect_refused(with([&](Config& c) { c.bind = bind; }), "one address of this machine, not all of them");
  for (const char* bind : {"", "127.0.0.1", "localhost:1", "127.0.0.1:65536", "127.0.0.1:", "127.0.0.1:+1", "x:1"})
    expect_refused(with([&](Config& c) { c.bind = bind; }), "bind: expected a numeric ADDRESS:PORT");
  expect_refused(with([](Config& c) { c.node = "[::1]:1"; }), "node: expected");
  expect_refused(with([](Config& c) { c.multicast = "127.0.0.1"; }), "multicast: expected");
  expect_refused(with([](Config& c) { c.multicast = "239.1.1.1", c.node = "127.0.0.1:1"; }), "node: expected");
  expect_refused(with([](Config& c) { c.layers = 1U << 11; }), "layers: expected");
  expect_refused(with([](Config& c) { c.max_window_tiles = 0; }), "max_window_tiles: expected");
  expect_refused(with([](Config& c) { c.repeats = 4; }), "repeats: expected");
  expect_refused(with([](Config& c) { c.tx_min = 5, c.tx_max = 4; }), "tx_min");
  expect_refused(with([](Config& c) { c.keys[1].id = 3; }), "keys: expected");
  expect_refused(with([](Config& c) { c.keys[0].id = c.keys[1].id = 3; }), "keys: expected two different ids");
  expect_refused(with([](Config& c) { c.node = "127.0.0.1:1", c.stream_id = Config::kAnyStream; }), "stream_id");
}

TEST(Socket, APortInUseIsRefusedAndMayBeTriedAgain) {
  Config config;
  config.bind = "127.0.0.1:0";
  auto first = std::make_unique<client::Client>();
  ASSERT_TRUE(first->open(config)) << first->error();
  const std::string taken = "127.0.0.1:" + std::to_string(first->port());
  config.bind = taken.c_str();
  client::Client second;
  EXPECT_FALSE(second.open(config));
  EXPECT_THAT(second.error(), HasSubstr(taken));
  first.reset();
  EXPECT_TRUE(second.open(config)) << second.error();
  EXPECT_FALSE(second.open(config)) << "an object is opened once";
}

TEST(Socket, HeartbeatMakesItFreshAndAnOversizedDatagramIsCounted) {
  Config config;
  config.bind = "127.0.0.1:0";
  client::Client map;
  ASSERT_TRUE(map.open(config)) << map.error();
  const Sender to(map.port());
  EXPECT_FALSE(map.wait(milliseconds(1)));
  EXPECT_FALSE(map.poll());
  EXPECT_EQ(map.state(), client::State::waiting);
  ASSERT_TRUE(to.send(std::vector<std::uint8_t>(1201)));
  ASSERT_TRUE(to.send(std::vector<std::uint8_t>(9000)));
  client::Time now;
  for (std::uint64_t seq = 1; seq <= 50 && map.state(now) != client::State::fresh; ++seq) {  // a machine may stall
    ASSERT_TRUE(to.heartbeat(seq));
    ASSERT_TRUE(map.wait(std::chrono::seconds(10)));
    now = Clock::now();
    EXPECT_TRUE(map.poll(now));
  }
  EXPECT_EQ(map.state(now), client::State::fresh);
  EXPECT_EQ(map.counters()[Verdict::too_long], 2U);
  EXPECT_EQ(map.state(now + milliseconds(301)), client::State::stale) << "without another poll";
  EXPECT_EQ(map.state(now + milliseconds(1001)), client::State::lost) << "without another poll";
}

// A program that hung for half a second finds heartbeats in the socket's buffer; they are as old as they are.
TEST(Socket, DatagramsAreAsOldAsTheKernelSays) {
  Config config;
  config.bind = "127.0.0.1:0";
  client::Client map;
  ASSERT_TRUE(map.open(config)) << map.error();
  ASSERT_TRUE(Sender(map.port()).heartbeat(1));
  std::this_thread::sleep_for(milliseconds(400));
  const auto now = Clock::now();
  EXPECT_TRUE(map.poll(now));
  EXPECT_EQ(map.state(now), client::State::stale);
  EXPECT_EQ(map.state(now + milliseconds(601)), client::State::lost);
}

TEST(Socket, WhatTheKernelDropsIsCounted) {
  Config config;
  config.bind = "127.0.0.1:0";
  client::Client map;
  ASSERT_TRUE(map.open(config)) << map.error();
  int buffer = 20'000;  // a small one, so that the test need not send much
  ASSERT_EQ(setsockopt(map.fd(), SOL_SOCKET, SO_RCVBUF, &buffer, sizeof buffer), 0);
  const Sender to(map.port());
  constexpr std::uint64_t kSent = 1000;
  for (std::uint64_t seq = 1; seq <= kSent; ++seq) ASSERT_TRUE(to.heartbeat(seq));
  map.poll();
  ASSERT_TRUE(to.heartbeat(kSent + 1));  // the kernel tells with the next one
  ASSERT_TRUE(map.wait(std::chrono::seconds(10)));
  map.poll();
  EXPECT_GT(map.counters().overflowed, 0U);
  EXPECT_EQ(map.counters().datagrams + map.counters().overflowed, kSent + 1);
  EXPECT_EQ(map.counters().lost, map.counters().overflowed);
}

TEST(Socket, AMulticastGroupHasSeveralListeners) {
  Config config;
  const std::string bind = "127.0.0.1:" + std::to_string(20000 + static_cast<int>(getpid()) % 12000);
  config.bind = bind.c_str();
  config.multicast = "239.255.71.3";
  client::Client one, two;
  if (!one.open(config)) GTEST_SKIP() << one.error();
  ASSERT_TRUE(two.open(config)) << two.error();
  if (!Sender(one.port(), config.multicast).heartbeat(1)) GTEST_SKIP() << "no multicast on this machine's loopback";
  for (client::Client* map : {&one, &two}) {
    EXPECT_TRUE(map->wait(std::chrono::seconds(10)));
    EXPECT_TRUE(map->poll());
    EXPECT_NE(map->state(), client::State::waiting);
  }
}

TEST(Socket, WhatNeedsAHumanIsLoggedOnce) {
  std::string log;
  Config config;
  config.log = [](void* user, const char* text) { *static_cast<std::string*>(user) += text; };
  config.log_user = &log;
  config.stream_id = 7;
  client::Receiver receiver;
  ASSERT_TRUE(receiver.open(config));
  const auto sim = golden_vector("announce");
  for (int i = 0; i < 3; ++i) EXPECT_EQ(receiver.accept(sim.data(), sim.size(), Clock::now()), Verdict::origin);
  EXPECT_THAT(log, HasSubstr("refused for its origin"));
  EXPECT_EQ(log.find("refused for its origin"), log.rfind("refused for its origin"));
  EXPECT_EQ(receiver.counters()[Verdict::origin], 3U);
}

}  // namespace
}  // namespace scree::test
