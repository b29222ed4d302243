#include "node/pose_input.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <vector>

#include "node/inbox.hpp"
#include "tests/node/golden.hpp"

namespace scree::node {
namespace {

using namespace std::chrono_literals;
using protocol::Reject;

const Time kStart{std::chrono::seconds(1'700'000'000)};

struct PoseSource {
  PoseReceiver receiver{*parse_address("127.0.0.1", "test"), 7};
  Endpoint from = *parse_endpoint("127.0.0.1:5555", "test");
  protocol::Header header;
  std::uint64_t next_seq = 1;
  protocol::PoseInputMessage message;
  protocol::Datagram last;
  const protocol::Key* key = nullptr;

  PoseSource() {
    header.stream_id = 7;
    header.boot_id = 21;
  }
  bool send(Duration since_start, double x_m = 0.0) {
    protocol::Datagram& datagram = last;
    header.seq = next_seq++;
    message.time = kStart + since_start;
    message.T_map_body.translation_m.x() = x_m;
    protocol::encode(header, message, datagram, key);
    return receiver.accept(datagram.view(), from, kStart + 10s);
  }
  std::uint64_t rejected(Reject reason) const {
    return receiver.counters().rejected_by[static_cast<std::size_t>(reason)];
  }
};

TEST(PoseInput, InterpolatesBetweenPosesAndKnowsNothingOutside) {
  PoseSource source;
  ASSERT_TRUE(source.send(1s, 1.0));
  source.message.T_map_body.rotation = Eigen::Quaterniond(Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitZ()));
  ASSERT_TRUE(source.send(2s, 3.0));
  const PoseHistory& history = source.receiver.history();
  const auto middle = history.at(kStart + 1250ms);
  ASSERT_TRUE(middle);
  EXPECT_DOUBLE_EQ(middle->T_map_body.translation_m.x(), 1.5);
  EXPECT_NEAR(Eigen::AngleAxisd(middle->T_map_body.rotation).angle(), 0.125, 1e-12);
  EXPECT_TRUE(history.at(kStart + 1s));
  EXPECT_TRUE(history.at(kStart + 2s));
  EXPECT_FALSE(history.at(kStart + 999ms));
  EXPECT_FALSE(history.at(kStart + 2001ms));
  EXPECT_EQ(history.newest()->time, kStart + 2s);
}

TEST(PoseInput, VariancesComeWithThePosesAndAreInterpolated) {
  PoseSource source;
  source.message.variances = {1.0f, 2.0f, 4.0f, 0.5f, 0.25f, 0.125f};
  ASSERT_TRUE(source.send(1s));
  source.message.variances = {3.0f, 2.0f, 8.0f, 0.5f, 0.75f, 0.125f};
  ASSERT_TRUE(source.send(2s));
  const auto middle = source.receiver.history().at(kStart + 1500ms);
  ASSERT_TRUE(middle);
  EXPECT_EQ(middle->variance.position_m2, Eigen::Vector3d(2.0, 2.0, 6.0));
  EXPECT_EQ(middle->variance.attitude_rad2, Eigen::Vector3d(0.5, 0.5, 0.125));
  EXPECT_EQ(source.receiver.history().newest()->variance.position_m2, Eigen::Vector3d(3.0, 2.0, 8.0));
}

TEST(PoseInput, KeepsTheNewestPosesOnly) {
  PoseHistory history;
  for (int i = 0; i < 10'000; ++i) history.add({kStart + i * 1ms, Pose{}});
  EXPECT_EQ(history.size(), PoseHistory::kCapacity);
  EXPECT_EQ(history.newest()->time, kStart + 9999ms);
  const Time oldest = kStart + std::chrono::milliseconds(10'000 - static_cast<int>(PoseHistory::kCapacity));
  EXPECT_TRUE(history.at(oldest));
  EXPECT_FALSE(history.at(oldest - 1ns));
  for (int i = 0; i < 4095; ++i) EXPECT_TRUE(history.at(oldest + i * 1ms + 500us));
}

TEST(PoseInput, AcceptsNoOtherAddress) {
  PoseSource source;
  source.from = *parse_endpoint("127.0.0.2:5555", "test");
  EXPECT_FALSE(source.send(1s));
  EXPECT_EQ(source.receiver.counters().foreign_address, 1u);
  source.from = *parse_endpoint("127.0.0.1:9", "test");  // any port of the right one
  EXPECT_TRUE(source.send(2s));
}

TEST(PoseInput, SequenceAndTimeOnlyGoUp) {
  PoseSource source;
  EXPECT_TRUE(source.send(1s));
  EXPECT_FALSE(source.send(1s));
  EXPECT_FALSE(source.send(500ms));
  EXPECT_EQ(source.receiver.counters().not_later, 2u);
  source.next_seq = 1;
  EXPECT_FALSE(source.send(2s));
  EXPECT_EQ(source.rejected(Reject::sequence), 1u);
  EXPECT_TRUE(source.send(3s));
  EXPECT_FALSE(source.send(11s + 1ms));  // the node's clock says 10 s
  EXPECT_EQ(source.receiver.counters().in_future, 1u);
  EXPECT_TRUE(source.send(4s));
  EXPECT_EQ(source.receiver.counters().datagrams, 7u);
  EXPECT_EQ(source.receiver.counters().accepted, 3u);
  EXPECT_EQ(source.receiver.counters().rejected, 4u);
}

TEST(PoseInput, RestartedSourceBeginsANewHistoryButTimeGoesOn) {
  PoseSource source;
  EXPECT_TRUE(source.send(5s));
  source.header.boot_id = 22;
  source.next_seq = 1;
  EXPECT_FALSE(source.send(4s)) << "recorded before the restart";
  EXPECT_EQ(source.receiver.counters().not_later, 1u);
  EXPECT_TRUE(source.send(5s + 1ms));
  EXPECT_EQ(source.receiver.history().size(), 1u);
  source.header.boot_id = 21;
  source.next_seq = 100;
  EXPECT_FALSE(source.send(6s));
  EXPECT_EQ(source.rejected(Reject::old_boot), 1u);
}

// More boots than are remembered: the first one's datagrams have a boot_id that is not known any more.
TEST(PoseInput, ReplayedSessionOfAForgottenBootIsRefusedByItsTime) {
  PoseSource source;
  std::vector<protocol::Datagram> recorded;
  for (std::uint64_t boot = 1; boot <= 20; ++boot) {
    source.header.boot_id = boot;
    source.next_seq = 1;
    ASSERT_TRUE(source.send(static_cast<int>(boot) * 100ms));
    recorded.push_back(source.last);
  }
  for (const auto& datagram : recorded)
    EXPECT_FALSE(source.receiver.accept(datagram.view(), source.from, kStart + 10s));
  EXPECT_EQ(source.receiver.counters().accepted, 20u);
  EXPECT_EQ(source.receiver.history().newest()->time, kStart + 2s);

  PoseSource restarted_node;  // remembers nothing, but knows what time it is
  EXPECT_FALSE(restarted_node.receiver.accept(recorded[0].view(), source.from, kStart + 10s + 101ms));
  EXPECT_EQ(restarted_node.receiver.counters().in_past, 1u);
}

TEST(PoseInput, WithAKeyOnlyItsMacIsTrusted) {
  protocol::KeyRing keys;
  ASSERT_TRUE(keys.add({1, {0x11}}));
  PoseSource source;
  source.receiver = PoseReceiver(*parse_address("127.0.0.1", "test"), 7, keys);
  EXPECT_FALSE(source.send(1s));  // unsigned
  const protocol::Key wrong{1, {0x22}};
  source.key = &wrong;
  EXPECT_FALSE(source.send(2s));
  EXPECT_EQ(source.rejected(Reject::mac), 2u);
  source.key = keys.signer();
  EXPECT_TRUE(source.send(3s));
  EXPECT_EQ(source.receiver.history().size(), 1u);
}

TEST(PoseInput, RefusedDatagramOfAnotherBootLeavesTheGoodSourceAlone) {
  PoseSource source;
  ASSERT_TRUE(source.send(1s));
  ASSERT_TRUE(source.send(2s));
  source.header.boot_id = 22;
  source.next_seq = 1'000'000;
  EXPECT_FALSE(source.send(20s));  // the node's clock says 10 s
  EXPECT_EQ(source.receiver.counters().in_future, 1u);
  EXPECT_EQ(source.receiver.history().size(), 2u);
  source.header.boot_id = 21;
  source.next_seq = 3;
  EXPECT_TRUE(source.send(3s));
  EXPECT_TRUE(source.receiver.history().at(kStart + 1500ms));
}

TEST(PoseInput, RefusedDatagramDoesNotAdvanceTheSequence) {
  PoseSource source;
  ASSERT_TRUE(source.send(1s));
  source.next_seq = 1'000'000;
  EXPECT_FALSE(source.send(20s));
  EXPECT_FALSE(source.send(1s));
  source.next_seq = 2;
  EXPECT_TRUE(source.send(2s));
  EXPECT_EQ(source.rejected(Reject::sequence), 0u);
}

TEST(PoseInput, RefusesTimesAndPositionsWhoseDifferencesWouldOverflow) {
  PoseSource source;
  EXPECT_FALSE(source.send(1s, 1.1e8));
  EXPECT_FALSE(source.send(1s, std::numeric_limits<double>::quiet_NaN()));
  EXPECT_FALSE(source.send(-std::chrono::hours(2'500'000)));
  EXPECT_EQ(source.rejected(Reject::body_value), 3u);
  EXPECT_TRUE(source.send(1s, 1e8));
}

TEST(PoseInput, RefusesOtherStreamsTypesAndMac) {
  PoseSource source;
  source.header.stream_id = 8;
  EXPECT_FALSE(source.send(1s));
  EXPECT_EQ(source.rejected(Reject::stream), 1u);
  EXPECT_FALSE(source.receiver.accept(test::golden("heartbeat"), source.from, kStart));
  EXPECT_EQ(source.rejected(Reject::type), 1u);
  EXPECT_FALSE(source.receiver.accept(test::golden("heartbeat_mac"), source.from, kStart));
  EXPECT_EQ(source.rejected(Reject::mac), 1u);
}

TEST(Inbox, ReceivesPosesOverLoopbackOnAPortOfTheKernelsChoice) {
  const auto inbox = Inbox::open("127.0.0.1:0", "", 7);
  ASSERT_TRUE(inbox) << inbox.error().message;
  ASSERT_NE((*inbox)->port(), 0);
  const std::string address = "127.0.0.1:" + std::to_string((*inbox)->port());
  auto sender = UdpSocket::connect_to(*parse_endpoint(address, "test"), "test");
  ASSERT_TRUE(sender);
  protocol::Header header;
  header.stream_id = 7;
  header.boot_id = header.seq = 1;
  protocol::PoseInputMessage message;
  message.time = std::chrono::time_point_cast<Duration>(std::chrono::system_clock::now());
  message.T_map_body.translation_m = {1.5, -2.25, 0.125};
  protocol::Datagram datagram;
  encode(header, message, datagram);
  const auto view = datagram.view();
  sender->send(std::span(&view, 1));
  RequestQueue queue;
  ASSERT_TRUE((*inbox)->poll(2s, queue));
  PoseInput& poses = (*inbox)->poses();
  ASSERT_TRUE(poses.newest());
  EXPECT_EQ(poses.newest()->T_map_body.translation_m, message.T_map_body.translation_m);
  EXPECT_TRUE(poses.at(message.time));
  EXPECT_TRUE(poses.wait_for(message.time, 0ms, {}));
  EXPECT_FALSE(poses.wait_for(message.time + 1ns, 0ms, {}));
  EXPECT_TRUE(queue.empty());

  const auto second = Inbox::open(address, "", 7);
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().kind, ErrorKind::unavailable);
  EXPECT_EQ(second.error().message, "publish.listen " + address + ": expected a free UDP port, found it in use");
  for (const char* refused : {"0.0.0.0:0", "239.1.2.3:47801"})
    EXPECT_EQ(Inbox::open(refused, "", 7).error().kind, ErrorKind::usage) << refused;
}

}  // namespace
}  // namespace scree::node
