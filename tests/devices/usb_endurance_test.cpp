// A thousand times over: nothing is left behind. And what a frame costs once all is warm.

#include <cstddef>
#include <cstdlib>
#include <gtest/gtest.h>
#include <thread>

#include "drivers/usb_transfers.hpp"
#include "tests/devices/process_resources.hpp"
#include "tests/devices/usb_fixture.hpp"

#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define SCREE_COUNTS_ALLOCATIONS 1

namespace {
thread_local long allocations = 0;
}

extern "C" {
void* __libc_malloc(std::size_t size);  // NOLINT
void* malloc(std::size_t size) {        // operator new and the C library end here
  ++allocations;
  return __libc_malloc(size);
}
}
#endif

namespace scree::drivers {
namespace {

using std::chrono::milliseconds;

/// What a process can leave behind. The testbed closes its ends a moment later than libusb does.
struct Holdings {
  std::ptrdiff_t descriptors = test::entries("/proc/self/fd"), threads = test::entries("/proc/self/task");
  std::size_t transfers = usb::Transfers::live();
  friend bool operator==(const Holdings&, const Holdings&) = default;
  friend std::ostream& operator<<(std::ostream& out, const Holdings& h) {
    return out << h.descriptors << " descriptors, " << h.threads << " threads, " << h.transfers << " transfers";
  }
  /// Unchanged for 200 ms.
  static Holdings settled() {
    Holdings last;
    for (int same = 0; same < 20;) {
      std::this_thread::sleep_for(milliseconds(10));
      const Holdings now;
      same = now == last ? same + 1 : 0;
      last = now;
    }
    return last;
  }
  static void expect_again(const Holdings& before) {
    for (int i = 0; i < 500 && !(Holdings() == before); ++i) std::this_thread::sleep_for(milliseconds(10));
    EXPECT_EQ(Holdings(), before);
  }
};

constexpr int kCycles = 1000;

TEST_F(UsbTest, AThousandUnplugsLeaveNothingBehind) {
  open_source();
  expect_notice("found none");
  Holdings before;
  for (int i = 0; i <= kCycles && !HasFailure(); ++i) {
    connect();
    scanner_.send(message(static_cast<std::uint64_t>(i)));
    expect_frame(static_cast<std::uint64_t>(i));
    if (i % 3 == 0) scanner_.send(stream::Bytes(20));  // and in the middle of something
    scanner_.unplug();
    expect_notice("has gone");
    if (i == 0) before = Holdings::settled();  // warm: frames, libusb's tables
  }
  EXPECT_EQ(counted("departures"), kCycles + 1u);
  EXPECT_EQ(before.transfers, 0u);
  Holdings::expect_again(before);
}

TEST_F(UsbTest, AThousandStartsAndStopsLeaveNothingBehind) {
  scanner_.plug();
  Holdings before;
  for (int i = 0; i <= kCycles && !HasFailure(); ++i) {
    open_source();
    expect_notice("connected");
    if (i % 2 == 0) {
      scanner_.send(message(1));
      expect_frame(1);
    }
    source_.reset();
    EXPECT_FALSE(scanner_.state().streaming);
    EXPECT_EQ(scanner_.state().in_flight, 0u) << "drained before it was closed";
    if (i == 0) before = Holdings::settled();  // warm: frames, libusb's tables
  }
  EXPECT_EQ(before.transfers, 0u);
  Holdings::expect_again(before);
}

TEST_F(UsbTest, ATransferThatNeverComesBackIsAbandonedWithinTheDeadline) {
  const std::size_t before = usb::Transfers::abandoned(), live = usb::Transfers::live();
  scanner_.change([](auto& state) { state.keeps_transfers = true; });
  scanner_.plug();
  open_source();
  expect_notice("connected");
  const auto begin = MonotonicClock::now();
  source_.reset();
  EXPECT_GE(MonotonicClock::now() - begin, milliseconds(500)) << "waited for";
  EXPECT_LT(MonotonicClock::now() - begin, milliseconds(2500)) << "and for one request at most besides";
  EXPECT_EQ(usb::Transfers::abandoned() - before, usb::kTransfers);
  EXPECT_EQ(usb::Transfers::live() - live, usb::kTransfers);
  scanner_.change([](auto& state) { state.keeps_transfers = false; });
  open_source();
  expect_notice("connected");
  scanner_.send(message(0));
  expect_frame(0);
}

TEST_F(UsbTest, AFrameTakesNothingFromTheHeapOnceAllIsWarm) {
#ifndef SCREE_COUNTS_ALLOCATIONS
  GTEST_SKIP() << "allocations are counted with glibc and without sanitizers only";
#else
  scanner_.plug();
  open_source();
  expect_notice("connected");
  std::vector<stream::Bytes> messages;
  for (std::uint64_t i = 0; i < 100; ++i) messages.push_back(message(i));
  for (const auto& bytes : messages) scanner_.send(bytes);
  const auto take = [&](int count) {
    for (int frames = 0; frames < count;) {
      const auto next = source_->next(milliseconds(1000));
      if (!next || next->kind != Kind::frame) return false;
      ++frames;
    }
    return true;
  };
  ASSERT_TRUE(take(50));
  const long before = allocations;
  ASSERT_TRUE(take(50));
  EXPECT_EQ(allocations - before, 0);
#endif
}

}  // namespace
}  // namespace scree::drivers
