// A frame of a stream takes nothing from the heap once the reader is warm.

#include <atomic>
#include <cstdlib>
#include <new>

#include "tests/drivers/stream_support.hpp"

#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define SCREE_COUNTS_ALLOCATIONS 1

namespace {
std::atomic<long> allocations{0};
}

extern "C" {
void* __libc_malloc(std::size_t size);  // NOLINT
void* malloc(std::size_t size) {        // operator new and the C library end here
  ++allocations;
  return __libc_malloc(size);
}
}
#endif

namespace scree::drivers::stream {
namespace {

TEST(StreamAllocation, AFrameTakesNothingFromTheHeapOnceTheReaderIsWarm) {
#ifndef SCREE_COUNTS_ALLOCATIONS
  GTEST_SKIP() << "allocations are counted with glibc and without sanitizers only";
#else
  const Encoder encoder = test_encoder();
  std::vector<Bytes> drive;
  for (std::uint64_t i = 0; i < 20; ++i) drive.push_back(encoded(encoder, test_frame(i)));
  Bytes out;
  Decoder decoder;
  FrameReader reader(as_told, true);
  RangeFrame frame;
  const auto run = [&] {
    for (std::uint64_t i = 0; i < drive.size(); ++i) {
      for (std::size_t at = 0; at < drive[i].size(); at += 100) {
        auto piece = std::span<const std::uint8_t>(drive[i]).subspan(at);
        if (piece.size() > 100) piece = piece.first(100);
        while (const auto message = decoder.next(piece)) {
          if (!reader.take(*message, frame)) return false;
        }
      }
    }
    return true;
  };
  ASSERT_TRUE(run());
  const long before = allocations;
  ASSERT_TRUE(run());
  EXPECT_EQ(allocations - before, 0);
  EXPECT_EQ(reader.taken(Taken::frame), 40u);
  const TestFrame again = test_frame(3);
  ASSERT_TRUE(encoder.encode(again.view(), out));
  const long warm = allocations;
  ASSERT_TRUE(encoder.encode(again.view(), out));
  EXPECT_EQ(allocations - warm, 0) << "the encoder neither";
#endif
}

}  // namespace
}  // namespace scree::drivers::stream
