// What a stream made to be expensive costs: counted in bytes checked and moved, not in time.

#include <gtest/gtest.h>
#include <numeric>

#include "core/random.hpp"
#include "drivers/checksum.hpp"
#include "tests/drivers/stream_support.hpp"

namespace scree::drivers::stream {
namespace {

/// A good header of a FRAME whose payload CRC is wrong for any bytes but by a chance of 2⁻³².
Bytes lying_header(std::size_t payload_bytes) {
  Bytes out(kHeaderBytes);
  Header header;
  header.payload_bytes = static_cast<std::uint32_t>(payload_bytes);
  header.payload_crc = 0xDEADBEEF;
  write_header(header, out);
  return out;
}

/// Headers back to back, each with a payload that ends where the stream does, but at most `reach` bytes on.
Bytes nested_headers(std::size_t count, std::size_t reach) {
  Bytes out;
  for (std::size_t i = 0; i < count; ++i) {
    const Bytes header = lying_header(std::min(reach, (count - 1 - i) * kHeaderBytes));
    out.insert(out.end(), header.begin(), header.end());
  }
  return out;
}

/// A byte is checked once with the message that it is in and once more for the marks; each header, 48 bytes at least
/// from the next, costs 44 of its own and less than two pitches of others'; growing and moving cost each byte once or
/// twice more, and a last header may begin a buffer of twice the largest payload.
std::uint64_t bound(std::uint64_t bytes) {
  return bytes * (2 + 4) + bytes / kHeaderBytes * (44 + 2 * PartialChecksums::kPitch);
}

TEST(StreamWork, NestedHeadersCostABoundedMultipleOfTheirBytes) {
  // checking each payload on its own would be count² / 2 · 48 bytes: ten thousand times each byte
  const Bytes bytes = nested_headers(20'000, kMaxPayloadBytes);
  for (const std::size_t piece : {bytes.size(), std::size_t{65'536}, std::size_t{1'000}}) {
    Ears ears;
    ears.hear_in_pieces(bytes, piece);
    EXPECT_EQ(ears.decoder.counters().payload_crc, 20'000u) << "all were looked at";
    EXPECT_LE(ears.decoder.counters().work, bound(bytes.size())) << piece;
  }
}

TEST(StreamWork, HeadersThatEachReachBeyondWhatIsHeldCostNoMove) {
  // each header wants 48 bytes more than the one before it: what is held would be moved to the front for each
  const std::size_t reach = std::size_t{4'000} * kHeaderBytes;
  const Bytes bytes = nested_headers(20'000, reach);
  Ears ears;
  ears.hear_in_pieces(bytes, 4'096);
  EXPECT_EQ(ears.decoder.counters().payload_crc, 20'000u);
  EXPECT_LE(ears.decoder.counters().work, bound(bytes.size()));
}

TEST(StreamWork, AFrameBehindNestedHeadersIsNotLost) {
  const Bytes frame = encoded(test_encoder(), test_frame(3));
  Bytes bytes;
  for (std::size_t i = 0; i < 500; ++i) {
    const Bytes header = lying_header((499 - i) * kHeaderBytes + 7 * i % frame.size());
    bytes.insert(bytes.end(), header.begin(), header.end());
  }
  bytes.insert(bytes.end(), frame.begin(), frame.end());
  bytes.insert(bytes.end(), frame.begin(), frame.end());
  for (const std::size_t piece : {bytes.size(), std::size_t{100}, std::size_t{1}}) {
    Ears ears;
    ears.hear_in_pieces(bytes, piece);
    EXPECT_EQ(ears.sequences(), (std::vector<std::uint64_t>{3, 3})) << piece;
    EXPECT_EQ(ears.decoder.counters().bytes_skipped, 500 * kHeaderBytes) << piece;
  }
}

TEST(StreamWork, AnUndamagedStreamIsCheckedOnceAndNeverMoved) {
  const Encoder encoder = test_encoder();
  Bytes bytes;
  for (std::uint64_t i = 0; i < 200; ++i) {
    const Bytes next = encoded(encoder, test_frame(i));
    bytes.insert(bytes.end(), next.begin(), next.end());
  }
  Ears ears;
  ears.hear_in_pieces(bytes, 1'000);
  EXPECT_EQ(ears.frames.size(), 200u);
  EXPECT_LE(ears.decoder.counters().work, bytes.size() + 1'000) << "and the first buffer";
}

TEST(PartialChecksums, AreThoseOfThePartsWhereverTheyLie) {
  Bytes bytes(20'000);
  for (std::size_t i = 0; i < bytes.size(); ++i)
    bytes[i] = static_cast<std::uint8_t>(random_words(7, 0, static_cast<std::int32_t>(i), 0)[0]);
  PartialChecksums parts;
  std::size_t at = 0;
  std::uint64_t least_read = 0;
  for (std::int32_t i = 0; at < bytes.size(); ++i) {
    const auto random = random_words(8, 0, i, 0);
    const std::size_t size = random[0] % (i % 3 == 0 ? 10 : 6'000);
    const auto part = std::span(bytes).subspan(at, std::min(size, bytes.size() - at));
    ASSERT_EQ(parts.crc(part, at), crc32_of(part)) << part.size() << " bytes at " << at;
    least_read += 2 * PartialChecksums::kPitch;
    at += i % 50 == 49 ? 1'000 : random[1] % 30;  // now and then behind all that is known
  }
  EXPECT_LE(parts.bytes_read(), bytes.size() + least_read);
}

}  // namespace
}  // namespace scree::drivers::stream
