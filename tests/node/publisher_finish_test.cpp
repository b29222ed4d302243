// The end of a publisher: nothing of the last map is lost, however slow the pacing and the kernel are.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <thread>
#include <unistd.h>

#include "node/protocol.hpp"
#include "tests/node/maps.hpp"
#include "tests/node/publishing.hpp"

namespace scree::node {
namespace {

using namespace std::chrono_literals;
using protocol::MessageType;
using test::kWindow;

// 280 blocks of at least 100 − 12 datagrams/s, which takes 3.2 s; sets of 6 manifests every 100 ms would leave 29.
TEST(PublisherFinish, SendsTheWholeMapAtTheLowestPacing) {
  const auto listener = test::open_listener();
  auto settings = test::settings_for(listener->port());
  settings.datagrams_per_s = 100;
  const auto publisher = test::open_publisher(settings);
  const auto map = test::make_snapshot(1, kWindow);
  publisher->submit(map);
  std::jthread sender([&] {
    const Status done = publisher->finish(test::status());
    EXPECT_TRUE(done) << done.error().message;
  });
  bool lost_early = false;
  for (const auto end = MonotonicClock::now() + 20s; !listener->ended() && MonotonicClock::now() < end;) {
    EXPECT_TRUE(listener->poll(5ms));
    lost_early = lost_early || (listener->link() == LinkState::lost && !listener->ended());
  }
  sender.join();
  EXPECT_TRUE(listener->ended());
  EXPECT_FALSE(lost_early) << "no heartbeat for a second";
  EXPECT_EQ(publisher->counters().blocks, 280u);
  EXPECT_EQ(publisher->counters().blocks_refreshed, 0u);
  ASSERT_TRUE(listener->last_valid_map());
  EXPECT_EQ(test::differing_cells(*listener->last_valid_map(), *test::quantised(*map)), 0u);
}

/// A publisher whose datagrams go through a queue of a few, which is read only when the test wants: loopback UDP never
/// blocks a sender, so a local socket takes the place of the publisher's.
struct SlowWay {
  int ours = -1;
  std::unique_ptr<Publisher> publisher;

  explicit SlowWay(const config::PublishSettings& settings) {
    const int next = dup(STDIN_FILENO);  // the descriptor that the publisher's socket will get
    close(next);
    publisher = test::open_publisher(settings);
    int type = 0;
    socklen_t size = sizeof type;
    EXPECT_EQ(getsockopt(next, SOL_SOCKET, SO_TYPE, &type, &size), 0);
    EXPECT_EQ(type, SOCK_DGRAM);
    int pair[2];
    EXPECT_EQ(socketpair(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0, pair), 0);
    const int few_bytes = 4096;
    EXPECT_EQ(setsockopt(pair[0], SOL_SOCKET, SO_SNDBUF, &few_bytes, sizeof few_bytes), 0);
    EXPECT_EQ(dup2(pair[0], next), next);
    close(pair[0]);
    ours = pair[1];
  }
  ~SlowWay() { close(ours); }
};

TEST(PublisherFinish, WaitsForTheKernelAndSkipsNoBye) {
  SlowWay way(test::settings_for(9));
  way.publisher->submit(test::make_snapshot(1, kWindow));
  int tiles = 0, byes = 0;
  std::jthread reader([&] {
    std::this_thread::sleep_for(300ms);
    std::array<std::uint8_t, 2048> bytes;
    while (byes < 3) {
      const ssize_t length = recv(way.ours, bytes.data(), bytes.size(), 0);
      if (length <= 0) return;
      protocol::Opened opened;
      EXPECT_EQ(protocol::open_datagram(std::span(bytes).first(static_cast<std::size_t>(length)), opened),
                protocol::Reject::none);
      tiles += opened.header.type == MessageType::tile ? 1 : 0;
      byes += opened.header.type == MessageType::bye ? 1 : 0;
    }
  });
  const Status done = way.publisher->finish(test::status());
  EXPECT_TRUE(done) << done.error().message;
  shutdown(way.ours, SHUT_RDWR);
  reader.join();
  EXPECT_EQ(tiles, 280);
  EXPECT_EQ(byes, 3);
  EXPECT_GT(way.publisher->counters().send_blocked, 0u);
}

TEST(PublisherFinish, GivesUpWhenNothingMovesForTwoSecondsAndSaysWhatIsMissing) {
  SlowWay way(test::settings_for(9));
  way.publisher->submit(test::make_snapshot(1, kWindow));
  const auto begin = MonotonicClock::now();
  const Status done = way.publisher->finish(test::status());
  EXPECT_GE(MonotonicClock::now() - begin, 2s);
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().kind, ErrorKind::io);
  EXPECT_THAT(
      done.error().message,
      ::testing::ContainsRegex("expected to send the last map and BYE, found that for 2 s nothing could be sent "
                               "\\([0-9]+ of 280 blocks and [0-9]+ datagrams waiting\\)"));
}

}  // namespace
}  // namespace scree::node
