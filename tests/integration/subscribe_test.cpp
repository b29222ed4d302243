// Clients that ask the node for its map: the real binary on both ends, and raw datagrams where somebody cheats.

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <signal.h>

#include "node/protocol.hpp"
#include "node/udp_socket.hpp"
#include "tests/integration/hand_made.hpp"
#include "tests/integration/live_node.hpp"

namespace scree::test {
namespace {

using namespace node::protocol;
using nlohmann::json;

const std::string kGoodKey(64, '5');
const std::string kOtherKey(64, '6');

/// A node that plays a loop to nobody, until it is stopped.
struct LoopingNode {
  TemporaryFolder folder;
  std::optional<Process> process;
  std::string address;

  explicit LoopingNode(std::vector<std::string> more = {}) {
    const auto recording = make_depth_recording(folder / "drive", every(0.1, 20), 0.5);
    std::vector<std::string> words{"run",
                                   "--config",
                                   live_config(folder / "robot.yaml", recording).string(),
                                   "--json",
                                   "--set",
                                   "publish.listen=127.0.0.1:0",
                                   "--set",
                                   "publish.destination=" + test::address(3),
                                   "--set",
                                   "source.loop=true"};
    words.insert(words.end(), more.begin(), more.end());
    process.emplace(command(words));
    EXPECT_TRUE(process->wait_for_text("listening at")) << process->err();
    address = listening_address(process->err());
  }
  json stop() {
    process->signal(SIGINT);
    const auto finished = process->wait(seconds(60));
    EXPECT_EQ(finished.exit_code, 0) << finished.err;
    return json::parse(finished.out, nullptr, false);
  }
  std::string key_file(const std::string& digits) {
    const auto file = folder / (digits.substr(0, 1) + ".key");
    write_file(file, digits + "\n");
    return file.string();
  }
};

/// One socket that talks to the node as it likes, and keeps what comes.
struct RawClient {
  node::UdpSocket socket = *node::UdpSocket::bind(*node::parse_endpoint("127.0.0.1:0", "test"), "test");
  node::Endpoint node;
  std::uint64_t seq = 0;
  std::size_t bytes_sent = 0;
  std::size_t bytes_received = 0;
  std::size_t tiles = 0;
  std::uint64_t cookie = 0;
  MonotonicTime last_heard;

  explicit RawClient(const std::string& address) : node(*node::parse_endpoint(address, "test")) {}
  template <class Message>
  void send(const Message& message) {
    Header header;
    header.stream_id = 1;
    header.boot_id = 99;
    header.seq = ++seq;
    Datagram datagram;
    encode(header, message, datagram);
    bytes_sent += datagram.size;
    const auto view = datagram.view();
    socket.send(std::span(&view, 1), &node);
  }
  void listen(milliseconds duration) {
    for (const auto end = MonotonicClock::now() + duration; MonotonicClock::now() < end;) {
      const auto received = socket.receive(milliseconds(10), [&](std::span<const std::uint8_t> bytes, const auto&) {
        bytes_received += bytes.size();
        last_heard = MonotonicClock::now();
        Opened opened;
        ASSERT_EQ(open_datagram(bytes, opened), Reject::none);
        tiles += opened.header.type == MessageType::tile ? 1 : 0;
        Cookie message;
        if (opened.header.type == MessageType::cookie && decode(opened, message) == Reject::none)
          cookie = message.cookie;
      });
      ASSERT_TRUE(received);
    }
  }
};

TEST(Subscribe, ListenerGetsTheMapOfANodeThatSendsElsewhere) {
  LoopingNode node;
  const auto heard = scree({"listen", "--node", node.address, "--duration", "5", "--json", "--repeats", "1"});
  ASSERT_EQ(heard.exit_code, 0) << heard.err;
  const json client = json::parse(heard.out);
  EXPECT_GT(client["cells_measured"], 1000);
  EXPECT_EQ(client["link"], "fresh");
  EXPECT_EQ(client["rejected"], 0);
  EXPECT_GE(client["client"]["subscribes"], 5);
  EXPECT_GE(client["client"]["pongs"], 4);
  EXPECT_LT(std::abs(client["client"]["clock_offset_ms"].get<double>()),
            client["client"]["round_trip_ms"].get<double>() + 0.1)
      << "one machine, one clock";
  const json statistics = node.stop();
  EXPECT_EQ(statistics["clients"]["begun"], 1);
  EXPECT_EQ(statistics["clients"]["ended"], 1) << "the listener says that it goes";
  // A listener that is scheduled late asks again before it has read the answer: a cookie each, no more.
  EXPECT_GE(statistics["clients"]["cookies"], 1);
  EXPECT_LE(statistics["clients"]["cookies"], client["client"]["subscribes"]);
  EXPECT_GT(statistics["publisher"]["poses"], 20);
  EXPECT_GT(statistics["publisher"]["blocks_repeated"], 0);
  EXPECT_GT(statistics["latency_out_ms"]["p50"], 0.0);
  EXPECT_GE(statistics["latency_out_ms"]["p50"], statistics["latency_ms"]["p50"]);
}

TEST(Subscribe, LayersThatAreNotAskedForDoNotCome) {
  LoopingNode node;
  const auto heard = scree({"listen", "--node", node.address, "--duration", "3", "--json", "--layers",
                            "cost,cell_state", "--map-out", (node.folder / "map.npy").string()});
  ASSERT_EQ(heard.exit_code, 0) << heard.err;
  EXPECT_TRUE(std::filesystem::exists(node.folder / "map.cost.npy"));
  EXPECT_FALSE(std::filesystem::exists(node.folder / "map.elevation.npy"));
  EXPECT_GT(json::parse(heard.out)["cells_measured"], 1000);
}

TEST(Subscribe, WithTheNodesKeyAloneTheMapComes) {
  LoopingNode node({"--set", "publish.keys=[{id: 7, hex: \"" + kGoodKey + "\"}]"});
  const auto listen = [&](std::vector<std::string> more) {
    std::vector<std::string> words{"listen", "--node", node.address, "--duration", "3", "--json"};
    words.insert(words.end(), more.begin(), more.end());
    const auto heard = scree(words);
    EXPECT_EQ(heard.exit_code, 0) << heard.err;
    return json::parse(heard.out, nullptr, false);
  };
  EXPECT_EQ(listen({})["datagrams"], 0) << "no key";
  EXPECT_EQ(listen({"--key", "7:" + node.key_file(kOtherKey)})["datagrams"], 0) << "another key of that id";
  EXPECT_EQ(listen({"--key", "8:" + node.key_file(kGoodKey)})["datagrams"], 0) << "another id of that key";
  const json good = listen({"--key", "7:" + node.key_file(kGoodKey)});
  EXPECT_GT(good["cells_measured"], 1000);
  EXPECT_EQ(good["rejected"], 0);
  const json statistics = node.stop();
  EXPECT_GE(statistics["received"]["requests_rejected"]["mac"], 3 * 6) << "SUBSCRIBE and PING, each three times";
  EXPECT_EQ(statistics["clients"]["begun"], 1);
  EXPECT_THAT(node.process->err(), ::testing::Not(::testing::HasSubstr(kGoodKey.substr(0, 8))));
}

TEST(Subscribe, ListenerWithAKeyRefusesWhatIsNotSigned) {
  const TemporaryFolder folder;
  write_file(folder / "good.key", kGoodKey);
  Process hears(command({"listen", "--address", address(1), "--duration", "4", "--json", "--key",
                         "7:" + (folder / "good.key").string()}));
  ASSERT_TRUE(hears.wait_for_text("listening at"));
  const auto replayed =
      scree(replay(small_recording().string(), {"--rate", "max", "--set", "publish.destination=" + address(1)}));
  EXPECT_EQ(replayed.exit_code, 0) << replayed.err;
  const json heard = json::parse(hears.wait().out);
  EXPECT_GT(heard["datagrams"], 100);
  EXPECT_EQ(heard["rejected_by"]["mac"], heard["datagrams"]);
  EXPECT_EQ(heard["cells_measured"], 0);
}

TEST(Subscribe, StreamEndsWithItsLease) {
  LoopingNode node;
  RawClient client(node.address);
  client.send(node::protocol::Subscribe{0, 1, {}, 0, 0});
  client.listen(milliseconds(500));
  ASSERT_NE(client.cookie, 0u);
  const auto before = MonotonicClock::now();
  client.send(node::protocol::Subscribe{client.cookie, 1, {}, 0, 0});
  client.listen(seconds(5));
  EXPECT_GT(client.tiles, 10u);
  EXPECT_GT(client.last_heard - before, milliseconds(2500)) << "heartbeats every 100 ms for 3 s";
  EXPECT_LT(client.last_heard - before, milliseconds(4500)) << "3 s, and what a loaded machine adds";
  const json statistics = node.stop();
  EXPECT_EQ(statistics["clients"]["lease_expired"], 1);
}

TEST(Subscribe, WhoNeverEchoesACookieIsSentAtMostThreeTimesWhatItSent) {
  LoopingNode node;
  RawClient client(node.address);
  for (int i = 0; i < 30; ++i) {
    client.send(node::protocol::Subscribe{0, ~std::uint64_t{0}, {}, 0, 3});
    client.send(node::protocol::Subscribe{12345, ~std::uint64_t{0}, {}, 0, 3});
    client.send(Ping{1, 1});
    Nack nack;
    nack.count = 128;
    client.send(nack);
    client.listen(milliseconds(30));
  }
  client.listen(seconds(1));
  EXPECT_GT(client.bytes_received, 0u);
  EXPECT_LE(client.bytes_received, 3 * client.bytes_sent);
  EXPECT_EQ(client.tiles, 0u);
  const json statistics = node.stop();
  EXPECT_EQ(statistics["clients"]["nacks_unsubscribed"], 30);
  EXPECT_EQ(statistics["clients"]["begun"], 0);
}

TEST(Subscribe, OptionsThatCannotWorkAreUsageErrors) {
  EXPECT_EQ(scree({"listen", "--node", "127.0.0.1:0", "--duration", "0"}).exit_code, 64);
  EXPECT_EQ(scree({"listen", "--node", "10.0.0.1:47801", "--duration", "0"}).exit_code, 64) << "from which address?";
  EXPECT_EQ(scree({"listen", "--layers", "colour", "--duration", "0"}).exit_code, 64);
  EXPECT_EQ(scree({"listen", "--key", "0:x", "--duration", "0"}).exit_code, 64);
  EXPECT_EQ(scree({"listen", "--key", "1:/nowhere", "--duration", "0"}).exit_code, 66);
}

}  // namespace
}  // namespace scree::test
