#include "node/frame_queue.hpp"

#include <algorithm>
#include <chrono>
#include <gtest/gtest.h>
#include <thread>
#include <vector>

namespace scree::node {
namespace {

using namespace std::chrono_literals;
using Pushed = FrameQueue::Pushed;

constexpr Time kNow{std::chrono::seconds(1000)};

std::shared_ptr<const RangeFrame> frame(std::uint64_t sequence, Time time = kNow) {
  auto made = std::make_shared<RangeFrame>();
  made->sequence = sequence;
  made->time = time;
  return made;
}

FrameQueue::Config lossless(std::size_t capacity) {
  return {QueuePolicy::lossless, capacity, 1, {}};
}
FrameQueue::Config merging(Duration merge, std::size_t sources = 2) {
  return {QueuePolicy::newest_wins, 1, sources, merge};
}

TEST(FrameQueue, NewestWinsAndCountsWhatItLoses) {
  FrameQueue queue({QueuePolicy::newest_wins, 1, 1, {}});
  for (std::uint64_t i = 1; i <= 5; ++i) EXPECT_EQ(Pushed::taken, queue.push(frame(i), 0, kNow, {}));
  EXPECT_EQ(queue.pop({}).frame->sequence, 5u);
  EXPECT_EQ(queue.dropped(), 4u);
  EXPECT_EQ(queue.losses(0).dropped, 4u);
}

TEST(FrameQueue, LosslessKeepsEveryFrameInOrder) {
  FrameQueue queue(lossless(2));
  std::jthread producer([&] {
    for (std::uint64_t i = 0; i < 200; ++i) EXPECT_EQ(Pushed::taken, queue.push(frame(i), 0, kNow, {}));
    queue.close();
  });
  for (std::uint64_t i = 0; i < 200; ++i) EXPECT_EQ(queue.pop({}).frame->sequence, i);
  EXPECT_EQ(queue.pop({}).frame, nullptr);
  EXPECT_EQ(queue.dropped(), 0u);
}

TEST(FrameQueue, StopEndsAWaitForRoomAndAWaitForAFrame) {
  FrameQueue full(lossless(1));
  EXPECT_EQ(Pushed::taken, full.push(frame(1), 0, kNow, {}));
  FrameQueue empty(lossless(1));
  std::stop_source stop;
  std::jthread stopper([&] { stop.request_stop(); });
  EXPECT_EQ(Pushed::stopped, full.push(frame(2), 0, kNow, stop.get_token()));
  EXPECT_EQ(empty.pop(stop.get_token()).frame, nullptr);
}

TEST(FrameQueue, SeveralSourcesAreGivenInTheOrderOfTheirEnds) {
  FrameQueue queue(merging(1s));
  EXPECT_EQ(Pushed::taken, queue.push(frame(1, kNow - 10ms), 0, kNow, {}));
  EXPECT_EQ(Pushed::taken, queue.push(frame(2, kNow - 30ms), 1, kNow, {}));
  const auto first = queue.pop({});
  EXPECT_EQ(first.frame->sequence, 2u);
  EXPECT_EQ(first.source, 1u);
  queue.close();
  EXPECT_EQ(queue.pop({}).frame->sequence, 1u);
  EXPECT_EQ(queue.dropped(), 0u);
}

TEST(FrameQueue, AFrameWaitsForTheSlowerSource) {
  FrameQueue queue(merging(60s));
  // source 1 has told a frame 2 s after it was taken, source 0 tells at once
  EXPECT_EQ(Pushed::taken, queue.push(frame(1, kNow - 2s), 1, kNow, {}));
  EXPECT_EQ(queue.pop({}).frame->sequence, 1u);
  EXPECT_EQ(Pushed::taken, queue.push(frame(3, kNow + 50ms), 0, kNow + 50ms, {}));
  std::jthread slow([&] {
    std::this_thread::sleep_for(10ms);
    EXPECT_EQ(Pushed::taken, queue.push(frame(4, kNow + 40ms), 1, kNow + 60ms, {}));
  });
  EXPECT_EQ(queue.pop({}).frame->sequence, 4u) << "it ended earlier, although it came later";
  queue.close();
  EXPECT_EQ(queue.pop({}).frame->sequence, 3u);
}

TEST(FrameQueue, AFrameWaitsNoLongerThanTheOthersLateness) {
  FrameQueue queue(merging(60s));
  EXPECT_EQ(Pushed::taken, queue.push(frame(1, kNow - 100ms), 1, kNow, {}));
  EXPECT_EQ(queue.pop({}).frame->sequence, 1u);
  const auto before = MonotonicClock::now();
  EXPECT_EQ(Pushed::taken, queue.push(frame(2, kNow), 0, kNow, {}));
  EXPECT_EQ(queue.pop({}).frame->sequence, 2u);  // nothing comes: given 105 ms after it arrived
  EXPECT_GE(MonotonicClock::now() - before, 90ms);
  EXPECT_LT(MonotonicClock::now() - before, 30s) << "not the limit of 60 s";
}

TEST(FrameQueue, WhatComesAfterALaterFrameIsDroppedAndCounted) {
  FrameQueue queue(merging(Duration(0)));
  EXPECT_EQ(Pushed::taken, queue.push(frame(1, kNow), 0, kNow, {}));
  EXPECT_EQ(queue.pop({}).frame->sequence, 1u);
  EXPECT_EQ(Pushed::late, queue.push(frame(2, kNow - 1ms), 1, kNow, {}));
  EXPECT_EQ(Pushed::taken, queue.push(frame(3, kNow + 1ms), 0, kNow + 1ms, {}));
  EXPECT_EQ(queue.pop({}).frame->sequence, 3u);
  EXPECT_EQ(queue.losses(1).late, 1u);
  EXPECT_EQ(queue.dropped(), 1u);
}

// A camera every 20 ms beside a scanner whose frames come 200 ms after their end: frames are held for longer than the
// camera's period and given all the same.
TEST(FrameQueue, AFastSourceIsNotStarvedByALateOne) {
  FrameQueue queue(merging(60s));
  EXPECT_EQ(Pushed::taken, queue.push(frame(0, kNow - 200ms), 1, kNow, {}));
  EXPECT_EQ(queue.pop({}).source, 1u);
  std::vector<std::uint64_t> given;
  std::jthread camera([&] {
    for (std::uint64_t i = 1; i <= 20; ++i) {
      const Time now = kNow + i * 20ms;
      EXPECT_EQ(Pushed::taken, queue.push(frame(i, now), 0, now, {}));
      std::this_thread::sleep_for(20ms);
    }
  });
  while (given.empty() || given.back() < 20) {
    const auto entry = queue.pop({});
    ASSERT_NE(entry.frame, nullptr);
    given.push_back(entry.frame->sequence);
  }
  EXPECT_TRUE(std::is_sorted(given.begin(), given.end()));
  EXPECT_GE(given.size(), 3u) << "a machine that stops for long loses some; one that starves it gives the last alone";
}

TEST(FrameQueue, OfFramesThatNeedNotBeHeldTheNewestWins) {
  FrameQueue queue(merging(Duration(0)));  // nothing is held
  for (std::uint64_t i = 1; i <= 5; ++i)
    EXPECT_EQ(Pushed::taken, queue.push(frame(i, kNow + i * 1ms), 0, kNow + i * 1ms, {}));
  EXPECT_EQ(queue.pop({}).frame->sequence, 5u) << "map did not keep up";
  EXPECT_EQ(queue.losses(0).dropped, 4u);
}

TEST(FrameQueue, AClockThatIsSetBackStarvesNobody) {
  FrameQueue queue(merging(Duration(0)));
  EXPECT_EQ(Pushed::taken, queue.push(frame(1, kNow), 0, kNow, {}));
  EXPECT_EQ(queue.pop({}).frame->sequence, 1u);
  const Time back = kNow - 1h;
  EXPECT_EQ(Pushed::taken, queue.push(frame(2, back), 1, back, {}));
  EXPECT_EQ(queue.pop({}).frame->sequence, 2u);
}

// Every 1.5 s is a source too: a quick one waits for its frames.
TEST(FrameQueue, ASlowSourceIsWaitedForByItsOwnInterval) {
  FrameQueue queue(merging(60s));
  EXPECT_EQ(Pushed::taken, queue.push(frame(1, kNow - 1000ms), 1, kNow, {}));
  EXPECT_EQ(queue.pop({}).source, 1u);
  std::this_thread::sleep_for(1500ms);
  EXPECT_EQ(Pushed::taken, queue.push(frame(2, kNow + 500ms), 1, kNow + 1500ms, {}));
  EXPECT_EQ(queue.pop({}).source, 1u);
  std::this_thread::sleep_for(1500ms);
  EXPECT_EQ(Pushed::taken, queue.push(frame(3, kNow + 3000ms), 0, kNow + 3000ms, {}));
  std::jthread slow([&] {
    std::this_thread::sleep_for(20ms);
    EXPECT_EQ(Pushed::taken, queue.push(frame(4, kNow + 2020ms), 1, kNow + 3020ms, {}));
  });
  EXPECT_EQ(queue.pop({}).frame->sequence, 4u);
  EXPECT_EQ(queue.pop({}).frame->sequence, 3u);
}

TEST(FrameQueue, ASilentSourceHoldsNobodyBack) {
  FrameQueue queue(merging(60s, 3));
  EXPECT_EQ(Pushed::taken, queue.push(frame(1, kNow), 0, kNow, {}));
  const auto before = MonotonicClock::now();
  EXPECT_EQ(queue.pop({}).frame->sequence, 1u);
  EXPECT_LT(MonotonicClock::now() - before, 30s);
}

TEST(FrameQueue, AClockThatRunsAheadMakesNobodyElseLate) {
  FrameQueue queue(merging(Duration(0)));
  EXPECT_EQ(Pushed::taken, queue.push(frame(1, kNow + 1h), 0, kNow, {}));
  EXPECT_EQ(queue.pop({}).frame->sequence, 1u);
  EXPECT_EQ(Pushed::taken, queue.push(frame(2, kNow + 1ms), 1, kNow + 1ms, {}));
  EXPECT_EQ(queue.pop({}).frame->sequence, 2u);
  EXPECT_EQ(queue.dropped(), 0u);
}

}  // namespace
}  // namespace scree::node
