// The live source and the sending end over real sockets of this machine.

#include "drivers/stream_source.hpp"

#include <filesystem>
#include <gmock/gmock.h>
#include <thread>

#include "drivers/stream_server.hpp"
#include "tests/drivers/stream_support.hpp"
#include "tests/support/temporary_folder.hpp"

namespace scree::drivers {
namespace {

using std::chrono::milliseconds;
using stream::Bytes;
using Kind = SourceEvent::Kind;

std::shared_ptr<const Bytes> message(std::uint64_t sequence, bool simulated = true) {
  auto encoder = stream::Encoder::make(stream::test_scanner(), stream::kTestBoot, simulated);
  return std::make_shared<const Bytes>(stream::encoded(*encoder, stream::test_frame(sequence)));
}

/// A served stream and a source that is connected to it.
class StreamSourceTest : public ::testing::Test {
 protected:
  void open_server() {
    server_.reset();
    auto opened = StreamServer::open(address());
    ASSERT_TRUE(opened) << opened.error().message;
    server_ = *std::move(opened);
  }
  void open_source(StreamSourceConfig config = {}, stream::SensorFor sensor_for = stream::as_told) {
    config.address = address();
    auto opened = open_stream(config, std::move(sensor_for));
    ASSERT_TRUE(opened) << opened.error().message;
    source_ = *std::move(opened);
  }
  std::string address() const { return "unix:" + (folder_ / "stream").string(); }

  /// The next event that is no timeout; the server serves meanwhile. An event of Kind::timeout after 10 s.
  SourceEvent event() {
    for (const auto limit = MonotonicClock::now() + std::chrono::seconds(10); MonotonicClock::now() < limit;) {
      if (server_) server_->serve();
      auto next = source_->next(milliseconds(2));
      EXPECT_TRUE(next) << next.error().message;
      if (!next || next->kind != Kind::timeout) return next ? *next : SourceEvent{};
    }
    return {};
  }
  std::uint64_t counted(const std::string& name) const {
    const auto counters = source_->counters();
    for (const auto& item : counters.items())
      if (item.name == name) return item.value;
    ADD_FAILURE() << "no counter " << name;
    return 0;
  }
  void connect() {
    const auto connected = event();
    EXPECT_EQ(connected.kind, Kind::notice);
    EXPECT_THAT(connected.message, ::testing::HasSubstr("connected"));
    while (server_->readers() == 0) server_->serve();
  }

  test::TemporaryFolder folder_;
  std::optional<StreamServer> server_;
  std::unique_ptr<Source> source_;
};

TEST_F(StreamSourceTest, FramesArriveAndTheSimulatedOnesSaySo) {
  open_server();
  open_source();
  connect();
  server_->send({message(0, false)});
  EXPECT_EQ(event().kind, Kind::frame);
  EXPECT_EQ(source_->origin(), Origin::live);
  server_->send({message(1, true)});
  const auto simulated = event();
  ASSERT_EQ(simulated.kind, Kind::frame);
  EXPECT_EQ(simulated.frame->sequence, 1u);
  EXPECT_THAT(simulated.message, ::testing::HasSubstr("simulated"));
  EXPECT_EQ(source_->origin(), Origin::sim);
  server_->send({message(2, false)});
  EXPECT_EQ(event().kind, Kind::frame);
  EXPECT_EQ(source_->origin(), Origin::sim) << "the map holds simulated ground by now";
}

TEST_F(StreamSourceTest, HilStaysHil) {
  open_server();
  StreamSourceConfig config;
  config.origin = Origin::hil;
  open_source(config);
  connect();
  server_->send({message(0)});
  EXPECT_EQ(event().kind, Kind::frame);
  EXPECT_EQ(source_->origin(), Origin::hil);
}

TEST_F(StreamSourceTest, ALostDeviceIsANoticeAndFramesGoOnWhenItIsBack) {
  open_source();
  EXPECT_THAT(event().message, ::testing::HasSubstr("trying again"));
  open_server();
  connect();
  server_->send({message(0)});
  EXPECT_EQ(event().kind, Kind::frame);
  server_.reset();
  const auto lost = event();
  EXPECT_EQ(lost.kind, Kind::notice);
  EXPECT_THAT(lost.message, ::testing::HasSubstr("closed the connection"));
  EXPECT_THAT(event().message, ::testing::HasSubstr("trying again"));
  open_server();
  connect();
  server_->send({message(5)});
  EXPECT_EQ(event().kind, Kind::frame);
  EXPECT_EQ(counted("connections"), 2u);
  EXPECT_EQ(counted("frames_missing"), 4u);
}

TEST_F(StreamSourceTest, RetriesBeginAt100MillisecondsAndDouble) {
  open_source();
  const auto begin = MonotonicClock::now();
  // attempts at 0, 100, 300, 700 ms: in 800 ms the socket is looked for four times, so one that appears just after
  // 300 ms is found at 700 ms and not before
  while (MonotonicClock::now() < begin + milliseconds(320)) (void)source_->next(milliseconds(10));
  open_server();
  const auto found = event();
  EXPECT_THAT(found.message, ::testing::HasSubstr("connected"));
  EXPECT_GE(MonotonicClock::now() - begin, milliseconds(650));
}

TEST_F(StreamSourceTest, ASilentPeerIsGivenUpAndConnectedToAgain) {
  open_server();
  StreamSourceConfig config;
  config.deadline = milliseconds(150);
  open_source(config);
  connect();
  const auto begin = MonotonicClock::now();
  const auto silent = event();
  EXPECT_EQ(silent.kind, Kind::notice);
  EXPECT_THAT(silent.message, ::testing::HasSubstr("expected a frame within 150 ms, found none"));
  EXPECT_GE(MonotonicClock::now() - begin, milliseconds(100));
  EXPECT_EQ(counted("silences"), 1u);
  EXPECT_THAT(event().message, ::testing::HasSubstr("connected"));
}

TEST_F(StreamSourceTest, ADamagedFrameIsSkippedOnceAndCounted) {
  open_server();
  open_source();
  connect();
  Bytes bytes = *message(0);
  Bytes damaged = *message(1);
  damaged.back() ^= 1;
  bytes.insert(bytes.end(), damaged.begin(), damaged.end());
  const auto last = message(2);
  bytes.insert(bytes.end(), last->begin(), last->end());
  server_->send({std::make_shared<const Bytes>(bytes)});
  EXPECT_EQ(event().kind, Kind::frame);
  const auto skipped = event();
  EXPECT_EQ(skipped.kind, Kind::skipped);
  EXPECT_THAT(skipped.message, ::testing::HasSubstr("CRC"));
  const auto next = event();
  ASSERT_EQ(next.kind, Kind::frame);
  EXPECT_EQ(next.frame->sequence, 2u);
  EXPECT_EQ(counted("payload_crc"), 1u);
  EXPECT_EQ(counted("frames_missing"), 1u);
  // GEOMETRY 1 was good; the whole of FRAME 1 is skipped
  EXPECT_EQ(counted("bytes_skipped"), damaged.size() - stream::kHeaderBytes - stream::kGeometryBytes);
}

TEST_F(StreamSourceTest, AFrameWithoutPosesIsSkippedWithAdvice) {
  open_server();
  open_source();
  connect();
  auto frame = stream::test_frame(0);
  frame.poses.clear();
  server_->send({std::make_shared<const Bytes>(stream::encoded(stream::test_encoder(), frame))});
  const auto skipped = event();
  EXPECT_EQ(skipped.kind, Kind::skipped);
  EXPECT_THAT(skipped.message, ::testing::HasSubstr("pose.source udp or static"));
  EXPECT_EQ(counted("no_pose"), 1u);
}

TEST_F(StreamSourceTest, ASensorThatIsNotTheConfiguredOneEndsTheSource) {
  open_server();
  open_source({}, [](const SensorConfig&) -> Result<SensorConfig> {
    return Error{ErrorKind::bad_config, "sensor.parameters.rows: expected 5, found 3"};
  });
  connect();
  server_->send({message(0)});
  Result<SourceEvent> next = SourceEvent{};
  for (int i = 0; next && i < 1000; ++i) {
    server_->serve();
    next = source_->next(milliseconds(2));
  }
  ASSERT_FALSE(next);
  EXPECT_EQ(next.error().kind, ErrorKind::bad_config);
  EXPECT_THAT(next.error().message, ::testing::MatchesRegex("stream unix:.*: sensor.parameters.rows: expected 5.*"));
}

// The configuration is judged by the first GEOMETRY. What the device says of itself after good frames is its own fault.
TEST_F(StreamSourceTest, ADeviceThatBecomesAnotherIsRefusedUntilItIsTheOldOneAgain) {
  open_server();
  open_source({}, [](const SensorConfig& told) -> Result<SensorConfig> {
    if (told.filter.range_max_m > 1e3) return Error{ErrorKind::bad_config, "expected another device, found this"};
    return told;
  });
  connect();
  server_->send({message(0)});
  EXPECT_EQ(event().kind, Kind::frame);
  auto other = stream::test_scanner();
  other.sensor.filter.range_max_m = 2e3;
  const auto encoder = stream::Encoder::make(other, stream::kTestBoot, true);
  server_->send({std::make_shared<const Bytes>(stream::encoded(*encoder, stream::test_frame(1)))});
  const auto refused = event();
  EXPECT_EQ(refused.kind, Kind::skipped);
  EXPECT_THAT(refused.message, ::testing::HasSubstr("expected another device, found this"));
  EXPECT_EQ(counted("bad_geometry"), 1u);
  server_->send({message(2)});
  EXPECT_EQ(event().kind, Kind::frame);
}

TEST_F(StreamSourceTest, APeerThatOnlySaysWhatItIsIsSilent) {
  open_server();
  StreamSourceConfig config;
  config.deadline = milliseconds(300);
  open_source(config);
  connect();
  Bytes geometry = *message(0);
  stream::Decoder decoder;
  std::span<const std::uint8_t> bytes(geometry);
  const auto first = decoder.next(bytes);
  ASSERT_TRUE(first && first->header.type == stream::MessageType::geometry);
  geometry.resize(stream::kHeaderBytes + first->payload.size());
  SourceEvent silent;
  for (int i = 0; i < 100 && silent.kind != Kind::notice; ++i) {
    if (!server_->busy()) server_->send({std::make_shared<const Bytes>(geometry)});
    server_->serve();
    auto next = source_->next(milliseconds(20));
    ASSERT_TRUE(next);
    silent = *next;
  }
  EXPECT_THAT(silent.message, ::testing::HasSubstr("expected a frame within 300 ms, found none"));
  EXPECT_EQ(counted("silences"), 1u);
}

TEST_F(StreamSourceTest, ASlowReaderMissesWholeFramesAndTheOthersDoNot) {
  open_server();
  auto slow = StreamSocket::connect_to(*parse_stream_address(address(), "test"), milliseconds(100));
  ASSERT_TRUE(slow);
  open_source();
  connect();
  while (server_->readers() < 2) server_->serve();
  std::uint64_t sent = 0;
  while (server_->counters().superseded == 0 && sent < 100'000) {  // until the kernel holds no more for the slow one
    server_->send({message(sent++)});
    EXPECT_EQ(event().kind, Kind::frame);
  }
  EXPECT_GT(server_->counters().superseded, 0u);
  Bytes heard, chunk(1 << 20);
  for (auto moved = slow->read(chunk, milliseconds(0)); moved.bytes > 0; moved = slow->read(chunk, milliseconds(20))) {
    heard.insert(heard.end(), chunk.begin(), chunk.begin() + static_cast<std::ptrdiff_t>(moved.bytes));
    server_->serve();
  }
  stream::Ears ears;
  ears.hear(heard);
  EXPECT_EQ(ears.decoder.counters().bytes_skipped + ears.decoder.held(), 0u) << "whole frames only";
  EXPECT_EQ(ears.frames.size(), sent - server_->counters().superseded);
}

TEST_F(StreamSourceTest, AnAddressIsServedOnceAndASocketLeftBehindIsTakenOver) {
  open_server();
  const auto second = StreamServer::open(address());
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().kind, ErrorKind::unavailable);
  server_.reset();
  EXPECT_FALSE(std::filesystem::exists(folder_ / "stream")) << "gone with its server";
  std::ofstream(folder_ / "stream") << "a file of somebody";
  EXPECT_FALSE(StreamServer::open(address()));
  EXPECT_TRUE(std::filesystem::exists(folder_ / "stream"));
}

TEST(StreamAddress, OnlyThisMachineIsAccepted) {
  const auto text = [](const std::string& address) {
    const auto parsed = parse_stream_address(address, "source.address");
    return parsed ? to_string(*parsed) : parsed.error().message;
  };
  EXPECT_EQ(text("unix:/tmp/x y"), "unix:/tmp/x y");
  EXPECT_EQ(text("tcp:47810"), "tcp:127.0.0.1:47810");
  EXPECT_EQ(text("tcp:localhost:1"), "tcp:127.0.0.1:1");
  EXPECT_EQ(text("tcp:127.3.2.1:0"), "tcp:127.3.2.1:0");
  EXPECT_EQ(text("tcp:[::1]:9"), "tcp:[::1]:9");
  for (const char* wrong : {"", "unix:", "udp:1", "tcp:", "tcp:65536", "tcp:192.168.0.1:80", "tcp:0.0.0.0:80",
                            "tcp:scanner:80", "tcp:127.0.0.1:-1", "tcp:127.0.0.1:80x"})
    EXPECT_THAT(text(wrong), ::testing::StartsWith("source.address: expected")) << wrong;
  EXPECT_THAT(text("unix:" + std::string(108, 'x')), ::testing::HasSubstr("1 … 107 bytes"));
}

TEST_F(StreamSourceTest, AnUnpluggedDeviceIsLostAndComesBackAtItsAddress) {
  open_server();
  open_source();
  connect();
  server_->set_link({.unplugged = true});
  EXPECT_EQ(event().kind, Kind::notice) << "gone";
  EXPECT_EQ(server_->readers(), 0u);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "stream")) << "nobody listens";
  server_->set_link({});
  SourceEvent came;
  for (int i = 0; i < 5 && !came.message.ends_with("connected"); ++i) came = event();
  EXPECT_TRUE(came.message.ends_with("connected")) << came.message;
  server_->serve();
  server_->send({message(0)});
  EXPECT_EQ(event().kind, Kind::frame);
}

TEST_F(StreamSourceTest, AFrozenLinkHoldsAFrameBack) {
  open_server();
  open_source();
  connect();
  server_->set_link({.frozen = true});
  server_->send({message(0)});
  for (int i = 0; i < 20; ++i) {
    server_->serve();
    EXPECT_EQ(source_->next(milliseconds(1))->kind, Kind::timeout);
  }
  EXPECT_TRUE(server_->busy());
  server_->set_link({});
  EXPECT_EQ(event().kind, Kind::frame);
}

TEST(StreamServer, TcpOnTheLoopbackWorksTheSame) {
  auto server = StreamServer::open("tcp:0");
  ASSERT_TRUE(server);
  StreamSourceConfig config;
  config.address = server->address();
  auto source = open_stream(config, stream::as_told);
  ASSERT_TRUE(source);
  std::vector<std::uint64_t> sequences;
  for (int i = 0; i < 2000 && sequences.size() < 3; ++i) {
    server->serve();
    if (server->readers() > 0 && !server->busy() && server->counters().sent < 3)
      server->send({message(server->counters().sent)});
    const auto event = (*source)->next(milliseconds(2));
    ASSERT_TRUE(event);
    if (event->kind == Kind::frame) sequences.push_back(event->frame->sequence);
  }
  EXPECT_EQ(sequences, (std::vector<std::uint64_t>{0, 1, 2}));
}

}  // namespace
}  // namespace scree::drivers
