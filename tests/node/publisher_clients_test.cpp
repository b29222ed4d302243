// The publisher with clients that ask: over real loopback sockets, on a clock of the test's own.

#include <functional>
#include <gtest/gtest.h>
#include <map>
#include <set>
#include <vector>

#include "node/inbox.hpp"
#include "node/listener_assembly.hpp"
#include "tests/node/maps.hpp"
#include "tests/node/publishing.hpp"

namespace scree::node {
namespace {

using namespace std::chrono_literals;
using drivers::Origin;
using protocol::Layer;
using protocol::MessageType;
using test::kWindow;
using test::Tap;

constexpr std::uint64_t kEverything = ~std::uint64_t{0};

struct Received {
  protocol::Header header;
  std::size_t bytes = 0;
  MonotonicTime at;
  protocol::TileBlock block;  ///< of a TILE
};

/// A client with its own socket: what it gets is kept.
struct Client {
  Tap tap;
  std::vector<Received> received;
  std::uint64_t cookie = 0;
  std::uint64_t boot_id = 77;
  std::uint64_t seq = 0;
  const protocol::Key* key = nullptr;
  std::size_t bytes_sent = 0;

  Endpoint endpoint() const { return *parse_endpoint("127.0.0.1:" + std::to_string(tap.socket.local_port()), "test"); }
  template <class Message>
  void send(const Message& message, std::uint16_t port, std::uint32_t stream_id = 1) {
    protocol::Header header;
    header.stream_id = stream_id;
    header.boot_id = boot_id;
    header.seq = ++seq;
    protocol::Datagram datagram;
    encode(header, message, datagram, key);
    bytes_sent += datagram.size;
    const auto view = datagram.view();
    const Endpoint node = *parse_endpoint("127.0.0.1:" + std::to_string(port), "test");
    ASSERT_EQ(tap.socket.send(std::span(&view, 1), &node).outcome, UdpSocket::Outcome::all);
  }
  std::size_t count(MessageType type) const {
    return static_cast<std::size_t>(
        std::count_if(received.begin(), received.end(), [&](const auto& r) { return r.header.type == type; }));
  }
  std::size_t bytes_received() const {
    std::size_t sum = 0;
    for (const Received& r : received) sum += r.bytes;
    return sum;
  }
};

/// A node without its map: publisher and inbox, ticked by the test.
struct Node {
  std::unique_ptr<Inbox> inbox;
  std::unique_ptr<Publisher> publisher;
  RequestQueue queue;
  MonotonicTime now = MonotonicClock::now();  // finish() reads that clock
  protocol::KeyRing keys;

  explicit Node(const config::PublishSettings& settings) {
    keys = *make_key_ring(settings.keys);
    inbox = *Inbox::open("127.0.0.1:0", "", settings.stream_id, keys);
    publisher = *Publisher::open(settings, Origin::live, 0.1, 0, inbox->socket());
  }
  std::uint16_t port() const { return inbox->port(); }
  void step(std::initializer_list<Client*> clients, Duration duration = 5ms) {
    for (const auto end = now + duration; now < end;) {
      now += 5ms;
      EXPECT_TRUE(inbox->poll(0ms, queue));
      for (Request request; queue.pop(request);) publisher->handle(request, now);
      publisher->tick(now, test::status());
      for (Client* client : clients) take(*client);
    }
  }
  void take(Client& client) const {
    client.tap.drain([&](std::span<const std::uint8_t> bytes) {
      protocol::Opened opened;
      if (protocol::open_datagram(bytes, opened, keys) != protocol::Reject::none) return;
      Received item{opened.header, bytes.size(), now, {}};
      if (opened.header.type == MessageType::tile) {
        EXPECT_EQ(decode(opened, item.block), protocol::Reject::none);
      }
      protocol::Cookie message;
      if (opened.header.type == MessageType::cookie && decode(opened, message) == protocol::Reject::none)
        client.cookie = message.cookie;
      client.received.push_back(item);
    });
  }
  /// Asks for a cookie, then with it.
  void subscribe(Client& client, protocol::Subscribe wish) {
    client.send(protocol::Subscribe{0, 1, {}, 0, 0}, port());
    step({&client});
    wish.cookie = client.cookie;
    client.send(wish, port());
  }
  /// Renews once a second of the test's clock.
  void run_subscribed(Client& client, protocol::Subscribe wish, int seconds) {
    for (int i = 0; i < seconds; ++i) {
      wish.cookie = client.cookie;
      client.send(wish, port());
      step({&client}, 1s);
    }
  }
};

config::PublishSettings settings_for(const Tap& fixed) {
  auto settings = test::settings_for(fixed.socket.local_port());
  settings.max_subscribers = 2;
  return settings;
}

TEST(PublisherClients, WithoutTheCookieAForgedAddressIsSentLessThanItSeemedToSend) {
  Tap fixed;
  Node node(settings_for(fixed));
  node.publisher->submit(test::make_snapshot(1, kWindow));
  Client client;
  for (int i = 0; i < 50; ++i) {
    client.send(protocol::Subscribe{0, kEverything, {}, 0, 3}, node.port());
    client.send(protocol::Subscribe{0xBAD, kEverything, {}, 0, 3}, node.port());
    client.send(protocol::Ping{1, 2}, node.port());
    protocol::Nack nack;
    nack.count = 128;
    client.send(nack, node.port());
    node.step({&client}, 100ms);
  }
  EXPECT_GT(client.received.size(), 0u);
  EXPECT_EQ(client.count(MessageType::tile), 0u);
  EXPECT_LT(client.bytes_received(), client.bytes_sent);
  EXPECT_EQ(node.publisher->subscriptions().nacks_unsubscribed, 50u);
  EXPECT_EQ(node.publisher->subscriptions().cookie_unknown, 50u);
  for (const Received& r : client.received) EXPECT_EQ(r.header.seq, 0u) << "not of a stream";
}

TEST(PublisherClients, SubscriberGetsTheWholeMapUntilItsLeaseEnds) {
  Tap fixed;
  Node node(settings_for(fixed));
  const auto map = test::make_snapshot(3, kWindow);
  node.publisher->submit(map);
  Client client;
  node.subscribe(client, {0, kEverything, {}, 0, 0});
  MapAssembly assembly({Origin::live});
  node.run_subscribed(client, {0, kEverything, {}, 0, 0}, 1);
  EXPECT_EQ(node.publisher->subscribers(), 1u);
  std::set<std::tuple<int, int, int, int>> blocks;
  std::uint64_t seq = 0;
  for (const Received& r : client.received) {
    if (r.header.seq == 0) continue;
    EXPECT_EQ(r.header.seq, ++seq);
    if (r.header.type == MessageType::tile)
      blocks.insert({r.block.tx, r.block.ty, static_cast<int>(r.block.layer), r.block.row0});
  }
  EXPECT_EQ(blocks.size(), 8u * 5u * 7u);
  EXPECT_GE(client.count(MessageType::announce), 1u);
  EXPECT_GE(client.count(MessageType::heartbeat), 9u);

  client.received.clear();
  const MonotonicTime renewed = node.now - 1s + 5ms;  // when the node read it
  node.step({&client}, 4s);
  ASSERT_GT(client.received.size(), 0u);
  EXPECT_LE(client.received.back().at, renewed + 3s);
  EXPECT_GT(client.received.back().at, renewed + 3s - 200ms);
  EXPECT_EQ(node.publisher->subscribers(), 0u);
  EXPECT_EQ(node.publisher->subscriptions().lease_expired, 1u);

  // and when it comes back, seq has not run backwards
  const std::uint64_t last = client.received.back().header.seq;
  client.received.clear();
  node.run_subscribed(client, {0, kEverything, {}, 0, 0}, 1);
  ASSERT_GT(client.received.size(), 0u);
  EXPECT_EQ(client.received.front().header.seq, last + 1);
}

TEST(PublisherClients, LayerMaskAndRegionAreHonoured) {
  Tap fixed;
  Node node(settings_for(fixed));
  node.publisher->submit(test::make_snapshot(1, kWindow));  // tiles -3 … 4 by 0 … 4
  Client client;
  const protocol::Subscribe wish{0, layer_bit(Layer::cost) | layer_bit(Layer::elevation), {-1, 1, 2, 2}, 0, 0};
  node.subscribe(client, wish);
  node.run_subscribed(client, wish, 2);
  std::map<Layer, std::set<std::pair<int, int>>> tiles;
  for (const Received& r : client.received)
    if (r.header.type == MessageType::tile) tiles[r.block.layer].insert({r.block.tx, r.block.ty});
  ASSERT_EQ(tiles.size(), 2u);
  for (const auto& [layer, held] : tiles) {
    EXPECT_EQ(held.size(), 4u * 2u);
    EXPECT_EQ(*held.begin(), std::pair(-1, 1));
    EXPECT_EQ(*held.rbegin(), std::pair(2, 2));
  }
  // a subscription changes with the next request
  client.received.clear();
  node.run_subscribed(client, {0, layer_bit(Layer::cell_state), {4, 4, 100, 100}, 0, 0}, 1);
  for (const Received& r : client.received)
    if (r.header.type == MessageType::tile && r.at > client.received.front().at) {
      EXPECT_EQ(r.block.layer, Layer::cell_state);
      EXPECT_EQ(std::pair(r.block.tx, r.block.ty), std::pair(4, 4));
    }
  client.send(protocol::Subscribe{client.cookie, 0, {}, 0, 0}, node.port());
  node.step({&client});
  client.received.clear();
  node.step({&client}, 1s);
  EXPECT_TRUE(client.received.empty());
  EXPECT_EQ(node.publisher->subscriptions().ended, 1u);
}

TEST(PublisherClients, RateIsTheClientsButNotAboveTheNodes) {
  Tap fixed;
  auto settings = settings_for(fixed);
  settings.datagrams_per_s = 400;
  Node node(settings);
  Client slow, greedy;
  node.subscribe(slow, {0, kEverything, {}, 100, 0});
  node.subscribe(greedy, {0, kEverything, {}, 1'000'000, 0});
  node.step({&slow, &greedy});
  slow.received.clear();
  greedy.received.clear();
  for (int step = 0; step < 20; ++step) {  // 2 s in which everything changes
    if (step % 10 == 0)
      for (auto* client : {&slow, &greedy})
        client->send(protocol::Subscribe{client->cookie, kEverything, {}, client == &slow ? 100u : 1'000'000u, 0},
                     node.port());
    node.publisher->submit(
        test::make_snapshot(static_cast<std::uint32_t>(step + 1), kWindow, static_cast<std::uint64_t>(step)));
    node.step({&slow, &greedy}, 100ms);
  }
  EXPECT_NEAR(static_cast<double>(slow.received.size()), 200.0, 20.0);
  EXPECT_NEAR(static_cast<double>(greedy.received.size()), 800.0, 30.0);
}

TEST(PublisherClients, RepeatsComeAtLeast20msBehindAndAreMarked) {
  Tap fixed;
  auto settings = settings_for(fixed);
  settings.refresh_ms = 60'000;
  Node node(settings);
  Client client;
  const protocol::Subscribe wish{0, layer_bit(Layer::cost), {}, 0, 2};
  node.subscribe(client, wish);
  node.publisher->submit(test::make_snapshot(1, kWindow));
  node.run_subscribed(client, wish, 1);
  std::map<std::pair<int, int>, std::vector<Received>> copies;
  for (const Received& r : client.received)
    if (r.header.type == MessageType::tile && (r.header.flags & protocol::kFlagRefresh) == 0)
      copies[{r.block.tx, r.block.ty}].push_back(r);
  ASSERT_EQ(copies.size(), 40u);
  for (const auto& [tile, sent] : copies) {
    ASSERT_EQ(sent.size(), 3u);
    for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ((sent[i].header.flags & protocol::kFlagRepeat) != 0, i > 0);
    for (std::size_t i = 1; i < 3; ++i) {
      EXPECT_GE(sent[i].at - sent[i - 1].at, 20ms);
      EXPECT_LE(sent[i].at - sent[i - 1].at, 60ms);
    }
  }
  EXPECT_EQ(node.publisher->counters().blocks_repeated, 80u);
}

TEST(PublisherClients, NackedTileComesAheadOfRefreshes) {
  Tap fixed;
  auto settings = settings_for(fixed);
  settings.refresh_ms = 60'000;
  Node node(settings);
  node.publisher->submit(test::make_snapshot(1, kWindow));
  Client client;
  node.subscribe(client, {0, kEverything, {}, 0, 0});
  node.run_subscribed(client, {0, kEverything, {}, 0, 0}, 1);
  client.received.clear();
  protocol::Nack nack;
  nack.cookie = client.cookie;
  nack.layer = Layer::elevation;
  nack.count = 3;
  nack.tiles[0] = {-3, 0};
  nack.tiles[1] = {4, 4};
  nack.tiles[2] = {99, 99};  // not in the map
  const MonotonicTime asked = node.now;
  client.send(nack, node.port());
  node.step({&client}, 50ms);
  std::set<std::tuple<int, int, int>> halves;
  for (const Received& r : client.received) {
    if (r.header.type != MessageType::tile || r.block.layer != Layer::elevation) continue;
    EXPECT_LE(r.at - asked, 10ms);
    halves.insert({r.block.tx, r.block.ty, r.block.row0});
  }
  EXPECT_EQ(halves.size(), 4u);
  EXPECT_EQ(node.publisher->subscriptions().nacks, 1u);
  EXPECT_EQ(node.publisher->subscriptions().nack_tiles, 3u);
  EXPECT_EQ(node.publisher->subscriptions().tiles_requeued, 2u);
}

TEST(PublisherClients, ClientThatStartsAgainOnItsPortGetsEverythingAgainAtOnce) {
  Tap fixed;
  auto settings = settings_for(fixed);
  settings.refresh_ms = 60'000;
  Node node(settings);
  node.publisher->submit(test::make_snapshot(1, kWindow));
  Client client;
  node.subscribe(client, {0, kEverything, {}, 0, 0});
  node.run_subscribed(client, {0, kEverything, {}, 0, 0}, 1);
  client.received.clear();
  client.boot_id = 78;
  client.seq = 0;
  client.send(protocol::Subscribe{client.cookie, kEverything, {}, 0, 0}, node.port());
  node.step({&client}, 500ms);
  EXPECT_GE(client.count(MessageType::tile), 280u);
  EXPECT_EQ(node.publisher->subscriptions().begun, 1u);
}

TEST(PublisherClients, ConfiguredDestinationThatSubscribesGetsNothingTwice) {
  Client client;  // the configured one
  auto settings = test::settings_for(client.tap.socket.local_port());
  settings.refresh_ms = 60'000;
  Node node(settings);
  node.publisher->submit(test::make_snapshot(1, kWindow));
  node.subscribe(client, {0, kEverything, {}, 0, 0});
  node.run_subscribed(client, {0, kEverything, {}, 0, 0}, 2);
  const PublisherCounters& counters = node.publisher->counters();
  EXPECT_EQ(client.count(MessageType::tile), counters.blocks);
  EXPECT_EQ(counters.blocks - counters.blocks_refreshed, 280u);
  EXPECT_EQ(node.publisher->subscribers(), 0u) << "it takes no place";
  EXPECT_EQ(node.publisher->subscriptions().begun, 1u);
  client.received.clear();
  protocol::Nack nack;
  nack.cookie = client.cookie;
  nack.count = 1;
  nack.tiles[0] = {0, 0};
  client.send(nack, node.port());
  node.step({&client}, 20ms);
  EXPECT_EQ(node.publisher->subscriptions().tiles_requeued, 1u) << "but it is heard";
  node.step({&client}, 4s);
  EXPECT_GT(client.count(MessageType::heartbeat), 35u) << "and goes on when its lease is over";
}

TEST(PublisherClients, PingIsAnsweredWithBothClocks) {
  Tap fixed;
  Node node(settings_for(fixed));
  Client client;
  client.send(protocol::Ping{0x1234, 42}, node.port());
  protocol::Pong pong;
  EXPECT_TRUE(node.inbox->poll(2s, node.queue));
  for (Request request; node.queue.pop(request);) node.publisher->handle(request, node.now);
  EXPECT_TRUE(client.tap.socket.receive(2s, [&](std::span<const std::uint8_t> bytes, const Endpoint& from) {
    protocol::Opened opened;
    ASSERT_EQ(protocol::open_datagram(bytes, opened), protocol::Reject::none);
    ASSERT_EQ(decode(opened, pong), protocol::Reject::none);
    EXPECT_EQ(from.port, node.port()) << "from where it asked";
    EXPECT_EQ(bytes.size(), client.bytes_sent);
  }));
  EXPECT_EQ(pong.nonce, 0x1234u);
  EXPECT_EQ(pong.t_request_ns, 42);
  EXPECT_GT(pong.t_receive_ns, 1'600'000'000'000'000'000);
  EXPECT_GE(pong.t_answer_ns, pong.t_receive_ns);
}

TEST(PublisherClients, WithAKeyOnlySignedRequestsAreHeardAndEverythingIsSigned) {
  Tap fixed;
  auto settings = settings_for(fixed);
  config::KeySettings key;
  key.id = 9;
  key.bytes.fill(0x5A);
  settings.keys = {key};
  Node node(settings);
  node.publisher->submit(test::make_snapshot(1, kWindow));
  const protocol::Key good{9, key.bytes}, forged{9, {}};
  Client client;
  for (const protocol::Key* wrong : {static_cast<const protocol::Key*>(nullptr), &forged}) {
    client.key = wrong;
    client.send(protocol::Subscribe{0, kEverything, {}, 0, 0}, node.port());
    node.step({&client}, 100ms);
  }
  EXPECT_TRUE(client.received.empty());
  EXPECT_EQ(node.inbox->counters().requests.rejected_by[static_cast<std::size_t>(protocol::Reject::mac)], 2u);
  client.key = &good;
  node.subscribe(client, {0, kEverything, {}, 0, 0});
  node.run_subscribed(client, {0, kEverything, {}, 0, 0}, 1);
  EXPECT_GE(client.count(MessageType::tile), 280u);
  for (const Received& r : client.received) {
    EXPECT_EQ(r.header.key_id, 9);
    EXPECT_NE(r.header.flags & protocol::kFlagMac, 0);
  }
}

TEST(PublisherClients, PosesGoToEveryDestinationOnce) {
  Tap fixed;
  Node node(settings_for(fixed));
  Client client;
  node.subscribe(client, {0, 1, {}, 0, 0});
  node.step({&client});
  std::vector<double> x_m;
  for (int i = 0; i < 10; ++i) {
    protocol::PoseMessage pose;
    pose.T_map_body.translation_m.x() = i;
    node.publisher->add_pose(pose, node.now - 3ms);
    node.step({&client});
  }
  EXPECT_EQ(client.count(MessageType::pose), 10u);
  EXPECT_EQ(node.publisher->counters().poses, 20u);
  for (int i = 0; i < 1000; ++i) node.publisher->add_pose({}, node.now);  // far more than the pacing takes
  node.step({&client});
  EXPECT_EQ(node.publisher->counters().poses_superseded, 2u * (1000 - 64));
}

TEST(PublisherClients, StreamAndTypeAreChecked) {
  Tap fixed;
  Node node(settings_for(fixed));
  Client client;
  client.send(protocol::Ping{}, node.port(), 2);
  client.send(protocol::Heartbeat{}, node.port());
  node.step({&client}, 20ms);
  const auto& counters = node.inbox->counters().requests;
  EXPECT_EQ(counters.rejected_by[static_cast<std::size_t>(protocol::Reject::stream)], 1u);
  EXPECT_EQ(counters.rejected_by[static_cast<std::size_t>(protocol::Reject::type)], 1u);
  EXPECT_TRUE(client.received.empty());
}

TEST(PublisherClients, SubscribersGetTheLastMapAndByeToo) {
  Tap fixed;
  Node node(settings_for(fixed));
  Client client;
  node.subscribe(client, {0, kEverything, {}, 0, 0});
  node.step({&client});
  node.publisher->submit(test::make_snapshot(1, kWindow));
  client.received.clear();
  const Status done = node.publisher->finish(test::status());
  EXPECT_TRUE(done) << done.error().message;
  node.take(client);
  EXPECT_EQ(client.count(MessageType::tile), 280u);
  EXPECT_EQ(client.count(MessageType::bye), 3u);
}

TEST(PublisherClients, GroupHearsTheMapOnTheInterfaceAsked) {
  auto group = UdpSocket::bind(*parse_endpoint("239.255.71.7:0", "test"), "test", "127.0.0.1");
  if (!group) GTEST_SKIP() << "no multicast here: " << group.error().message;
  config::PublishSettings settings;
  settings.destination = "239.255.71.7:" + std::to_string(group->local_port());
  settings.multicast_interface = "127.0.0.1";
  settings.multicast_ttl = 0;  // does not leave this machine
  auto publisher = Publisher::open(settings, Origin::live, 0.1, 0);
  ASSERT_TRUE(publisher) << publisher.error().message;
  const auto map = test::make_snapshot(1, kWindow);
  (*publisher)->submit(map);
  MapAssembly assembly({Origin::live});
  MonotonicTime now = map->received;
  for (int step = 0; step < 100; ++step, now += 5ms) {
    (*publisher)->tick(now, test::status());
    EXPECT_TRUE(group->receive(
        0ms, [&](std::span<const std::uint8_t> bytes, const Endpoint&) { assembly.accept(bytes, now); }));
  }
  if (assembly.counters().datagrams == 0) GTEST_SKIP() << "the loopback interface carries no multicast here";
  ASSERT_TRUE(assembly.map(now));
  EXPECT_EQ(test::differing_cells(*assembly.map(now), *test::quantised(*map)), 0u);
  settings.multicast_interface = "nowhere";
  EXPECT_EQ(Publisher::open(settings, Origin::live, 0.1, 0).error().kind, ErrorKind::usage);
}

}  // namespace
}  // namespace scree::node
