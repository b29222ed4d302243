#include "node/frame_queue.hpp"

#include <gtest/gtest.h>
#include <thread>

namespace scree::node {
namespace {

std::shared_ptr<const RangeFrame> frame(std::uint64_t sequence) {
  auto made = std::make_shared<RangeFrame>();
  made->sequence = sequence;
  return made;
}

TEST(FrameQueue, NewestWinsAndCountsWhatItLoses) {
  FrameQueue queue(QueuePolicy::newest_wins, 1);
  for (std::uint64_t i = 1; i <= 5; ++i) EXPECT_TRUE(queue.push(frame(i), {}));
  EXPECT_EQ(queue.pop({})->sequence, 5u);
  EXPECT_EQ(queue.dropped(), 4u);
}

TEST(FrameQueue, LosslessKeepsEveryFrameInOrder) {
  FrameQueue queue(QueuePolicy::lossless, 2);
  std::jthread producer([&] {
    for (std::uint64_t i = 0; i < 200; ++i) EXPECT_TRUE(queue.push(frame(i), {}));
    queue.close();
  });
  for (std::uint64_t i = 0; i < 200; ++i) EXPECT_EQ(queue.pop({})->sequence, i);
  EXPECT_EQ(queue.pop({}), nullptr);
  EXPECT_EQ(queue.dropped(), 0u);
}

TEST(FrameQueue, StopEndsAWaitForRoomAndAWaitForAFrame) {
  FrameQueue full(QueuePolicy::lossless, 1);
  EXPECT_TRUE(full.push(frame(1), {}));
  FrameQueue empty(QueuePolicy::lossless, 1);
  std::stop_source stop;
  std::jthread stopper([&] { stop.request_stop(); });
  EXPECT_FALSE(full.push(frame(2), stop.get_token()));
  EXPECT_EQ(empty.pop(stop.get_token()), nullptr);
}

}  // namespace
}  // namespace scree::node
