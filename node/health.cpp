#include "node/health.hpp"

#include <bit>
#include <spdlog/spdlog.h>

#include "node/protocol_header.hpp"

namespace scree::node {
namespace {

constexpr Duration kSameMoment = std::chrono::milliseconds(1);
constexpr int kTries = 3;

constexpr std::array<const char*, 16> kNames = {"sensor stale",
                                                "sensor lost",
                                                "pose stale",
                                                "overload",
                                                "calibration missing",
                                                "clock stepped",
                                                "reduced resolution",
                                                "recording failed",
                                                "8",
                                                "9",
                                                "10",
                                                "11",
                                                "12",
                                                "13",
                                                "14",
                                                "FAULT"};

Duration since_epoch(Time time) {
  return time.time_since_epoch();
}

}  // namespace

ClockReading read_clocks(bool& certain) {
  ClockReading reading;
  for (int i = 0; i < kTries; ++i) {
    reading.monotonic = MonotonicClock::now();
    reading.system = std::chrono::time_point_cast<Duration>(std::chrono::system_clock::now());
    certain = MonotonicClock::now() - reading.monotonic < kSameMoment;
    if (certain) break;
  }
  return reading;
}

void HealthState::note_clocks(const ClockReading& reading) {
  const Duration offset = since_epoch(reading.system) - reading.monotonic.time_since_epoch();
  const Duration moved = offset > offset_ ? offset - offset_ : offset_ - offset;
  stepped_ = stepped_ || (has_offset_ && moved > kClockStep);
  offset_ = offset;
  has_offset_ = true;
}

void HealthState::judge(std::uint16_t bit, bool bad, MonotonicTime now, Duration recovery) {
  MonotonicTime& last_bad = last_bad_[static_cast<std::size_t>(std::countr_zero(bit))];
  const bool set = (bits_ & bit) != 0;
  if (bad) last_bad = now;
  const bool next = bad || (set && now - last_bad < recovery);
  if (next == set) return;
  const char* const name = kNames[static_cast<std::size_t>(std::countr_zero(bit))];
  bits_ = static_cast<std::uint16_t>(next ? bits_ | bit : bits_ & ~bit);
  if (next) {
    ++transitions_;
    spdlog::warn("health: {}", name);
  } else {
    spdlog::info("health: no longer {}", name);
  }
}

std::uint16_t HealthState::update(const Condition& condition) {
  using namespace protocol;
  judge(kHealthSensorStale, condition.sensor_stale, condition.now, kRecovery);
  judge(kHealthSensorLost, condition.sensor_lost, condition.now, kRecovery);
  judge(kHealthPoseStale, condition.pose_stale, condition.now, kRecovery);
  judge(kHealthOverload, condition.frames_dropped > frames_dropped_, condition.now, kOverloadRecovery);
  judge(kHealthClockStepped, stepped_, condition.now, kClockRecovery);
  judge(kHealthRecordingFailed, condition.recording_failed, condition.now, kRecovery);
  judge(kHealthFault, condition.fault, condition.now, Duration::max());
  frames_dropped_ = condition.frames_dropped;
  stepped_ = false;
  return bits_;
}

}  // namespace scree::node
