// The USB source against usbfs as umockdev makes it: libusb, hotplug and asynchronous transfers are the real ones.

#include "drivers/usb_source.hpp"

#include <gtest/gtest.h>

#include "drivers/stream_server.hpp"
#include "drivers/stream_source.hpp"
#include "tests/devices/usb_fixture.hpp"
#include "tests/support/temporary_folder.hpp"

namespace scree::drivers {
namespace {

using std::chrono::milliseconds;
using stream::Bytes;
using Frames = std::vector<std::shared_ptr<const RangeFrame>>;

/// 96 × 512 pixels of 4 bytes: three transfers and a bit.
Bytes large_message(std::uint64_t sequence) {
  stream::Geometry geometry = stream::test_scanner();
  geometry.sensor.projection.rows = geometry.sensor.projection.columns = 0;
  geometry.sensor.projection = *complete_projection(geometry.sensor.projection, 96, 512);
  const auto encoder = stream::Encoder::make(geometry, stream::kTestBoot, true);
  EXPECT_TRUE(encoder) << encoder.error().message;
  stream::TestFrame frame = stream::test_frame(sequence);
  frame.row_time.assign(96, frame.row_time.front());
  frame.raw = frame.reflectance = Grid<std::uint16_t>(96, 512);
  for (std::size_t i = 0; i < frame.raw.size(); ++i) {
    frame.raw[i] = static_cast<std::uint16_t>((i * 7 + sequence) % 4096);
    frame.reflectance[i] = static_cast<std::uint16_t>((i * 13 + sequence) % 4096);
  }
  return stream::encoded(*encoder, frame);
}

/// What a StreamSource makes of the same messages.
Frames streamed(const std::vector<Bytes>& messages) {
  const test::TemporaryFolder folder;
  const std::string address = "unix:" + (folder / "stream").string();
  auto server = StreamServer::open(address);
  EXPECT_TRUE(server) << server.error().message;
  StreamSourceConfig config;
  config.address = address;
  const auto source = *open_stream(config, stream::as_told);
  Frames out;
  for (int i = 0; i < 10'000 && out.size() < messages.size(); ++i) {
    server->serve();
    if (server->readers() > 0 && !server->busy() && server->counters().sent < messages.size())
      server->send({std::make_shared<const Bytes>(messages[server->counters().sent])});
    const auto event = source->next(milliseconds(1));
    EXPECT_TRUE(event);
    if (event && event->kind == SourceEvent::Kind::frame) out.push_back(event->frame);
  }
  return out;
}

void expect_identical(const RangeFrame& a, const RangeFrame& b) {
  EXPECT_EQ(a.sequence, b.sequence);
  EXPECT_EQ(a.time, b.time);
  EXPECT_TRUE(stream::same_bits(a.range_m, b.range_m));
  EXPECT_EQ(a.raw, b.raw);
  EXPECT_EQ(a.reflectance, b.reflectance);
  EXPECT_EQ(a.row_time, b.row_time);
  ASSERT_EQ(a.T_map_body.size(), b.T_map_body.size());
  for (std::size_t r = 0; r < a.T_map_body.size(); ++r) {
    EXPECT_EQ(a.T_map_body[r].translation_m, b.T_map_body[r].translation_m);
    EXPECT_EQ(a.T_map_body[r].rotation.coeffs(), b.T_map_body[r].rotation.coeffs());
  }
  EXPECT_EQ(a.pose_variance.position_m2, b.pose_variance.position_m2);
  EXPECT_TRUE(stream::same_bits(a.projection->direction_x, b.projection->direction_x));
}

TEST_F(UsbTest, FramesAreThoseOfTheStreamSourceHoweverTheyAreCut) {
  std::vector<Bytes> messages;
  for (std::uint64_t i = 0; i < 12; ++i) messages.push_back(i % 2 == 0 ? large_message(i) : message(i));
  const Frames expected = streamed(messages);
  ASSERT_EQ(expected.size(), messages.size());
  open_source();
  expect_notice("usb 1209:0001: expected a device, found none");
  for (const std::size_t piece : {65'536, 16'384, 512, 509}) {
    connect();
    for (const Bytes& bytes : messages) {
      scanner_.send(bytes, piece);
      scanner_.answer({});  // a zero-length packet ends what is a whole number of packets
    }
    for (const auto& frame : expected) {
      const auto got = event();
      ASSERT_EQ(got.kind, Kind::frame) << got.message << " in pieces of " << piece;
      expect_identical(*got.frame, *frame);
    }
    scanner_.unplug();
    expect_notice("has gone");
  }
  EXPECT_EQ(counted("bytes_skipped"), 0u);
}

TEST_F(UsbTest, SimulatedFramesSaySoAndHilStaysHil) {
  open_source();
  expect_notice("expected a device");
  connect();
  scanner_.send(message(0));
  EXPECT_THAT(event().message, ::testing::HasSubstr("simulated"));
  EXPECT_EQ(source_->origin(), Origin::sim);
  scanner_.unplug();
  UsbSourceConfig config;
  config.origin = Origin::hil;
  open_source(config);
  expect_notice("expected a device");
  connect();
  scanner_.send(message(1));
  expect_frame(1);
  EXPECT_EQ(source_->origin(), Origin::hil);
}

TEST_F(UsbTest, ADamagedFrameIsSkippedOnceAndCounted) {
  scanner_.plug();
  open_source();
  expect_notice("connected");
  Bytes damaged = message(1);
  damaged.back() ^= 1;
  scanner_.send(message(0));
  scanner_.send(damaged);
  scanner_.send(message(2));
  expect_frame(0);
  const auto skipped = event();
  EXPECT_EQ(skipped.kind, Kind::skipped);
  EXPECT_THAT(skipped.message, ::testing::HasSubstr("CRC"));
  expect_frame(2);
  EXPECT_EQ(counted("payload_crc"), 1u);
  EXPECT_EQ(counted("frames_missing"), 1u);
}

TEST_F(UsbTest, AStallIsClearedAndCostsTheFrameItIsIn) {
  scanner_.plug();
  open_source();
  expect_notice("connected");
  scanner_.send(message(0));
  const Bytes cut = large_message(1);
  scanner_.answer(Bytes(cut.begin(), cut.begin() + 65'536));
  scanner_.answer(Bytes(cut.begin() + 65'536, cut.begin() + 65'536 + 512), -EPIPE);  // some of it came
  scanner_.send(large_message(2), 65'536);
  expect_frame(0);
  EXPECT_EQ(event().kind, Kind::skipped);
  expect_frame(2);
  EXPECT_EQ(counted("stalls"), 1u);
  EXPECT_EQ(scanner_.state().clear_halts, 2) << "one when it was opened";
  EXPECT_EQ(counted("bytes"), message(0).size() + 65'536 + 512 + large_message(2).size()) << "what came was used";
  EXPECT_EQ(counted("connections"), 1u);
}

TEST_F(UsbTest, OverflowAndErrorsAreCountedAndTheStreamGoesOn) {
  scanner_.plug();
  open_source();
  expect_notice("connected");
  scanner_.answer(Bytes(65'537));  // what is in flight behind it is not lost
  scanner_.send(message(0));
  expect_frame(0);
  EXPECT_EQ(source_->next(milliseconds(20))->kind, Kind::timeout);  // recovered meanwhile
  EXPECT_EQ(counted("overflows"), 1u);
  scanner_.answer({}, -EPROTO);
  scanner_.send(message(1));
  expect_frame(1);
  EXPECT_EQ(source_->next(milliseconds(20))->kind, Kind::timeout);
  EXPECT_EQ(counted("transfer_errors"), 1u);
  EXPECT_EQ(scanner_.state().clear_halts, 3);
}

TEST_F(UsbTest, ADeviceThatOnlyStallsIsClosedAndOpenedAgainLater) {
  scanner_.plug();
  open_source();
  expect_notice("connected");
  for (int i = 0; i < 5; ++i) scanner_.answer({}, -EPIPE);
  expect_notice("stalled, 5 times without a good message; connecting again");
  EXPECT_EQ(scanner_.state().streaming_off, 1);
  expect_notice("connected");
  scanner_.send(message(0));
  expect_frame(0);
  EXPECT_EQ(counted("stalls"), 5u);
}

TEST_F(UsbTest, ATransferThatCannotBeSubmittedClosesTheDevice) {
  scanner_.plug();
  open_source();
  expect_notice("connected");
  scanner_.change([](auto& state) { state.submit_error = ENOMEM; });
  scanner_.send(message(0));
  expect_frame(0);
  expect_notice("submitting a transfer: LIBUSB_ERROR_NO_MEM");
  expect_notice("submit a transfer: expected success, found LIBUSB_ERROR_NO_MEM");
  scanner_.change([](auto& state) { state.submit_error = 0; });
  expect_notice("connected");
}

TEST_F(UsbTest, ASilentDeviceHasItsStreamRestartedAndThenIsReset) {
  scanner_.plug();
  UsbSourceConfig config;
  config.deadline = milliseconds(150);
  open_source(config);
  expect_notice("connected");
  expect_notice("expected a frame within 150 ms, found none; stream restarted");
  EXPECT_EQ(scanner_.state().streaming_off, 1);
  EXPECT_EQ(scanner_.state().streaming_on, 2);
  EXPECT_EQ(scanner_.state().clear_halts, 2);
  EXPECT_EQ(scanner_.state().resets, 0);
  expect_notice("device reset; connecting again");
  EXPECT_EQ(scanner_.state().resets, 1);
  EXPECT_EQ(counted("silences"), 2u);
  expect_notice("connected");
}

TEST_F(UsbTest, ADeviceThatWakesUpWhenRestartedStaysConnected) {
  scanner_.change([](auto& state) { state.sends_after_restart = true; });
  scanner_.plug();
  UsbSourceConfig config;
  config.deadline = milliseconds(150);
  open_source(config);
  expect_notice("connected");
  scanner_.send(message(0));
  expect_notice("stream restarted");
  expect_frame(0);
  EXPECT_EQ(counted("connections"), 1u);
  EXPECT_EQ(counted("silences"), 1u);
}

TEST_F(UsbTest, ASensorThatIsNotTheConfiguredOneEndsTheSource) {
  scanner_.plug();
  open_source({}, [](const SensorConfig&) -> Result<SensorConfig> {
    return Error{ErrorKind::bad_config, "sensor.parameters.rows: expected 5, found 3"};
  });
  expect_notice("connected");
  scanner_.send(message(0));
  Result<SourceEvent> next = SourceEvent{};
  for (int i = 0; next && i < 1000; ++i) next = source_->next(milliseconds(2));
  ASSERT_FALSE(next);
  EXPECT_EQ(next.error().message, "usb 1209:0001: sensor.parameters.rows: expected 5, found 3");
}

}  // namespace
}  // namespace scree::drivers
