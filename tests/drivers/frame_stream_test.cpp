// The framing under everything that a byte stream can do to it.

#include <algorithm>
#include <numeric>

#include "core/random.hpp"
#include "drivers/checksum.hpp"
#include "drivers/little_endian.hpp"
#include "tests/drivers/stream_support.hpp"

namespace scree::drivers::stream {
namespace {

Bytes operator+(Bytes a, const Bytes& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

/// Frames 0 … count − 1, each with its GEOMETRY before it; and where each begins.
struct Drive {
  Bytes bytes;
  std::vector<std::size_t> begins;

  explicit Drive(std::uint64_t count) {
    const Encoder encoder = test_encoder();
    for (std::uint64_t i = 0; i < count; ++i) {
      begins.push_back(bytes.size());
      bytes = bytes + encoded(encoder, test_frame(i, static_cast<int>(i)));
    }
    begins.push_back(bytes.size());
  }
  std::uint64_t frame_at(std::size_t byte) const {
    return static_cast<std::uint64_t>(std::upper_bound(begins.begin(), begins.end(), byte) - begins.begin()) - 1;
  }
  std::vector<std::uint64_t> all_but(std::optional<std::uint64_t> lost) const {
    std::vector<std::uint64_t> out;
    for (std::uint64_t i = 0; i + 1 < begins.size(); ++i)
      if (i != lost) out.push_back(i);
    return out;
  }
};

Bytes noise(std::size_t count, std::uint64_t seed) {
  Bytes bytes(count);
  for (std::size_t i = 0; i < count; ++i)
    bytes[i] = static_cast<std::uint8_t>(random_words(seed, 1, static_cast<std::int32_t>(i), 0)[0]);
  return bytes;
}

TEST(FrameStream, AnyChunkingGivesTheSameFrames) {
  const Drive drive(5);
  const Bytes bytes = noise(70, 1) + drive.bytes + noise(33, 2);
  Ears whole;
  whole.hear(bytes);
  ASSERT_EQ(whole.sequences(), drive.all_but(std::nullopt));
  const auto expect_same = [&](const Ears& ears, std::size_t piece) {
    ASSERT_EQ(ears.sequences(), whole.sequences()) << piece;
    for (std::size_t i = 0; i < ears.frames.size(); ++i)
      EXPECT_TRUE(same_bits(ears.frames[i].range_m, whole.frames[i].range_m)) << piece;
    EXPECT_EQ(ears.decoder.counters().bytes_skipped, whole.decoder.counters().bytes_skipped) << piece;
    EXPECT_EQ(ears.decoder.counters().header_crc, whole.decoder.counters().header_crc) << piece;
  };
  for (std::size_t piece = 1; piece <= bytes.size(); piece += piece < 130 ? 1 : 97) {
    Ears ears;
    ears.hear_in_pieces(bytes, piece);
    expect_same(ears, piece);
  }
}

TEST(FrameStream, AChangedByteLosesAtMostTheFrameItIsIn) {
  const Drive drive(4);
  for (std::size_t at = 0; at < drive.bytes.size(); ++at)
    for (const int change : {0x01, 0x80, 0xFF}) {
      Bytes bytes = drive.bytes;
      bytes[at] = static_cast<std::uint8_t>(bytes[at] ^ change);
      Ears ears;
      ears.hear(bytes);
      const std::uint64_t hit = drive.frame_at(at);
      const bool in_geometry = at - drive.begins[hit] < kHeaderBytes + kGeometryBytes;
      // its GEOMETRY is known already, from the frame before
      const bool survives = in_geometry && hit > 0;
      ASSERT_EQ(ears.sequences(), drive.all_but(survives ? std::nullopt : std::optional(hit))) << "byte " << at;
      const DecoderCounters& c = ears.decoder.counters();
      EXPECT_GT(c.bytes_skipped, 0u) << "byte " << at;
      ears.decoder.reset();
      EXPECT_EQ(c.bytes, ears.message_bytes + c.bytes_skipped) << "byte " << at;
    }
}

TEST(FrameStream, AMissingOrSurplusByteLosesAtMostTheFrameItIsIn) {
  const Drive drive(4);
  for (std::size_t at = 0; at < drive.bytes.size(); ++at)
    for (const bool missing : {true, false}) {
      Bytes bytes = drive.bytes;
      const auto place = bytes.begin() + static_cast<std::ptrdiff_t>(at);
      if (missing)
        bytes.erase(place);
      else
        bytes.insert(place, 0x53);  // what a magic begins with
      Ears ears;
      ears.hear(bytes);
      const std::uint64_t hit = drive.frame_at(at);
      std::vector<std::uint64_t> got = ears.sequences();
      for (const std::uint64_t sequence : drive.all_but(hit))
        // the last message is waited for when bytes of it are missing
        EXPECT_TRUE(std::find(got.begin(), got.end(), sequence) != got.end()) << "byte " << at << " frame " << sequence;
      EXPECT_TRUE(std::is_sorted(got.begin(), got.end()));
    }
}

TEST(FrameStream, GarbageBetweenFramesCostsNoFrame) {
  const Encoder encoder = test_encoder();
  const Bytes magic(kMagic.begin(), kMagic.end());
  Bytes half_header = encoded(encoder, test_frame(9));
  half_header.resize(20);
  const std::vector<Bytes> garbage{noise(1000, 3), magic,       magic + magic + Bytes{0x53, 0x43},
                                   Bytes(48, 0),   half_header, Bytes{0x53}};
  Bytes bytes;
  std::uint64_t surplus = 0, sequence = 0;
  for (const Bytes& piece : garbage) {
    bytes = bytes + piece + encoded(encoder, test_frame(sequence++));
    surplus += piece.size();
  }
  Ears ears;
  ears.hear(bytes);
  EXPECT_EQ(ears.frames.size(), garbage.size());
  EXPECT_EQ(ears.decoder.counters().bytes_skipped, surplus);
  EXPECT_EQ(ears.decoder.held(), 0u);
}

TEST(FrameStream, AStreamThatBreaksOffLosesTheLastFrameAndEveryByteIsCounted) {
  const Drive drive(2);
  for (std::size_t end = drive.begins[1]; end < drive.bytes.size(); ++end) {
    Ears ears;
    ears.hear(std::span(drive.bytes).first(end));
    ASSERT_EQ(ears.sequences(), std::vector<std::uint64_t>{0}) << end;
    ears.decoder.reset();
    const DecoderCounters& c = ears.decoder.counters();
    EXPECT_EQ(c.bytes, end);
    EXPECT_EQ(c.bytes, ears.message_bytes + c.bytes_skipped) << end;
    ears.hear(drive.bytes);  // the next connection
    EXPECT_EQ(ears.sequences(), (std::vector<std::uint64_t>{0, 0, 1}));
  }
}

TEST(FrameStream, AnOversizePayloadIsRefusedAndNotWaitedFor) {
  Bytes header(kHeaderBytes);
  Header huge;
  huge.payload_bytes = kMaxPayloadBytes + 1;
  write_header(huge, header);
  const Drive drive(1);
  Ears ears;
  ears.hear(header + drive.bytes);
  EXPECT_EQ(ears.frames.size(), 1u);
  EXPECT_EQ(ears.decoder.counters().oversize, 1u);
  EXPECT_EQ(ears.decoder.counters().bytes_skipped, kHeaderBytes);
}

TEST(FrameStream, AnotherMajorVersionIsCountedAndSkipped) {
  Bytes header(kHeaderBytes);
  write_header({}, header);
  header[4] = 2;
  ByteWriter(std::span(header).subspan(44)).put(crc32_of(std::span(header).first(44)));
  Ears ears;
  ears.hear(header + Drive(1).bytes);
  EXPECT_EQ(ears.frames.size(), 1u);
  EXPECT_EQ(ears.decoder.counters().version, 1u);
}

TEST(FrameStream, AWholeMessageInsideAGoodPayloadIsNotLookedInto) {
  Bytes payload = Drive(1).bytes;
  Bytes message(kHeaderBytes);
  Header header;
  header.type = static_cast<MessageType>(77);
  header.payload_bytes = static_cast<std::uint32_t>(payload.size());
  header.payload_crc = crc32_of(payload);
  write_header(header, message);
  Ears ears;
  ears.hear(message + payload + Drive(1).bytes);
  EXPECT_EQ(ears.taken, (std::vector<Taken>{Taken::ignored_type, Taken::geometry, Taken::frame}));
  EXPECT_EQ(ears.decoder.counters().bytes_skipped, 0u);
}

TEST(FrameStream, TheEncoderRefusesWhatTheFormatCannotHold) {
  Geometry geometry = test_scanner();
  geometry.word_bytes = 2;
  EXPECT_FALSE(Encoder::make(geometry, 1, true)) << "a shift without reflectance";
  geometry = test_scanner();
  geometry.device = "";
  EXPECT_FALSE(Encoder::make(geometry, 1, true));
  geometry = test_scanner();
  geometry.sensor.projection.kind = ProjectionKind::cloud;
  EXPECT_FALSE(Encoder::make(geometry, 1, true));
  const Encoder encoder = test_encoder();
  Bytes out;
  TestFrame frame = test_frame(0);
  frame.raw(1, 1) = 4096;
  EXPECT_FALSE(encoder.encode(frame.view(), out));
  frame = test_frame(0);
  frame.row_time.pop_back();
  EXPECT_FALSE(encoder.encode(frame.view(), out));
}

}  // namespace
}  // namespace scree::drivers::stream
