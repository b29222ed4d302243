// The queue between mapping and the disk.

#include "node/recorder.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <thread>

#include "tests/support/temporary_folder.hpp"

namespace scree::node {
namespace {

std::shared_ptr<const RangeFrame> depth_frame(double t_s) {
  SensorConfig sensor;
  sensor.projection.kind = ProjectionKind::pinhole;
  sensor.projection.fx_px = sensor.projection.fy_px = 2.0;
  sensor.projection.cx_px = sensor.projection.cy_px = 0.5;
  auto frame = std::make_shared<RangeFrame>();
  frame->projection = *make_projection(sensor.projection, 2, 2);
  frame->sensor = std::make_shared<const SensorConfig>(sensor);
  frame->time = Time(from_seconds(t_s));
  frame->row_time.assign(2, frame->time);
  frame->raw = Grid<std::uint16_t>(2, 2, 1000);
  frame->range_m = Grid<float>(2, 2, 1.0F);
  return frame;
}

void add(Recorder& recorder, double t_s, std::size_t source = 0) {
  recorder.add(source, depth_frame(t_s), std::vector<Pose>(2), {}, drivers::Origin::live);
}

TEST(Recorder, AFullQueueDropsAndCountsAndNeverWaits) {
  const test::TemporaryFolder folder;
  auto recorder = Recorder::open((folder / "taken").string(), {.queue_frames = 3, .keep_free_mb = 0}, {"one"});
  ASSERT_TRUE(recorder) << recorder.error().message;
  for (int i = 0; i < 5; ++i) add(**recorder, i);  // nobody writes: this would hang if it waited
  EXPECT_EQ((*recorder)->counters().dropped, 2u);
  (*recorder)->close();
  (*recorder)->run();
  const auto counters = (*recorder)->counters();
  EXPECT_EQ(counters.frames, 3u);
  EXPECT_EQ(counters.dropped, 2u);
  EXPECT_FALSE(counters.failed);
}

TEST(Recorder, EverythingThatWasTakenIsWrittenBeforeItEnds) {
  const test::TemporaryFolder folder;
  auto recorder = Recorder::open((folder / "taken").string(), {.queue_frames = 64, .keep_free_mb = 0}, {"a", "b"});
  ASSERT_TRUE(recorder) << recorder.error().message;
  std::jthread writer([&] { (*recorder)->run(); });
  for (int i = 0; i < 40; ++i) add(**recorder, i, static_cast<std::size_t>(i % 2));
  (*recorder)->close();
  writer.join();
  const auto counters = (*recorder)->counters();
  EXPECT_EQ(counters.frames, 40u);
  EXPECT_EQ(counters.dropped + counters.refused, 0u);
  EXPECT_TRUE(std::filesystem::exists(folder / "taken" / "b" / "frames" / "000019.pgm"));
}

TEST(Recorder, AFrameThatTheFormatCannotHoldIsRefusedAndCounted) {
  const test::TemporaryFolder folder;
  auto recorder = Recorder::open((folder / "taken").string(), {.queue_frames = 8, .keep_free_mb = 0}, {"one"});
  ASSERT_TRUE(recorder);
  add(**recorder, 2);
  add(**recorder, 1);  // times go back
  add(**recorder, 3);
  (*recorder)->close();
  (*recorder)->run();
  EXPECT_EQ((*recorder)->counters().frames, 2u);
  EXPECT_EQ((*recorder)->counters().refused, 1u);
}

}  // namespace
}  // namespace scree::node
