// When health bits are set and cleared, on a clock of the test's own.

#include "node/health.hpp"

#include <gtest/gtest.h>

#include "node/protocol_header.hpp"

namespace scree::node {
namespace {

using namespace std::chrono_literals;
using namespace protocol;

struct Scene {
  HealthState health;
  Condition condition;
  Scene() { condition.now = MonotonicTime{} + 100s; }
  std::uint16_t after(Duration duration) {
    condition.now += duration;
    return health.update(condition);
  }
};

TEST(Health, BitIsSetAtOnceAndClearedAfterASecondOfGoodCondition) {
  Scene scene;
  EXPECT_EQ(scene.after(0ms), 0);
  scene.condition.sensor_stale = true;
  EXPECT_EQ(scene.after(1ms), kHealthSensorStale);
  scene.condition.sensor_stale = false;
  EXPECT_EQ(scene.after(999ms), kHealthSensorStale);
  scene.condition.sensor_stale = true;
  EXPECT_EQ(scene.after(0ms), kHealthSensorStale);
  scene.condition.sensor_stale = false;
  EXPECT_EQ(scene.after(999ms), kHealthSensorStale) << "the second begins anew";
  EXPECT_EQ(scene.after(1ms), 0);
  EXPECT_EQ(scene.health.transitions(), 1u);
}

TEST(Health, BitsAreIndependent) {
  Scene scene;
  scene.condition.sensor_stale = scene.condition.sensor_lost = scene.condition.pose_stale = true;
  EXPECT_EQ(scene.after(0ms), kHealthSensorStale | kHealthSensorLost | kHealthPoseStale);
  scene.condition.sensor_lost = scene.condition.pose_stale = false;
  EXPECT_EQ(scene.after(1s), kHealthSensorStale);
  EXPECT_EQ(scene.health.transitions(), 3u);
}

TEST(Health, OverloadIsWhileFramesAreDroppedAndThreeSecondsAfter) {
  Scene scene;
  for (int i = 0; i < 5; ++i) {
    ++scene.condition.frames_dropped;
    EXPECT_EQ(scene.after(2s), kHealthOverload);
  }
  EXPECT_EQ(scene.after(2999ms), kHealthOverload);
  EXPECT_EQ(scene.after(1ms), 0);
  EXPECT_EQ(scene.health.transitions(), 1u);
}

TEST(Health, FaultStays) {
  Scene scene;
  scene.condition.fault = true;
  EXPECT_EQ(scene.after(0ms), kHealthFault);
  scene.condition.fault = false;
  EXPECT_EQ(scene.after(std::chrono::hours(1000)), kHealthFault);
}

TEST(Health, StepOfTheSystemClockShowsForTenSecondsAndSlewingDoesNot) {
  Scene scene;
  Time system{std::chrono::seconds(1'700'000'000)};
  const auto tick = [&](Duration step) {
    system += 100ms + step;
    scene.condition.now += 100ms;
    scene.health.note_clocks({scene.condition.now, system});
    return scene.health.update(scene.condition);
  };
  for (int i = 0; i < 1000; ++i) ASSERT_EQ(tick(50us), 0) << "NTP slews by 0.5 ms/s";
  for (const Duration step : {Duration(51ms), Duration(-51ms), Duration(-std::chrono::hours(24))}) {
    EXPECT_EQ(tick(step), kHealthClockStepped);
    for (int i = 0; i < 99; ++i) ASSERT_EQ(tick(0ms), kHealthClockStepped);
    EXPECT_EQ(tick(0ms), 0);
  }
}

TEST(Health, ClocksAreReadAtOneMoment) {
  bool certain = false;
  const ClockReading first = read_clocks(certain);
  ASSERT_TRUE(certain);
  EXPECT_LE(first.monotonic, MonotonicClock::now());
}

}  // namespace
}  // namespace scree::node
