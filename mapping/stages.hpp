#pragma once
// Where the time of a frame goes.

#include <array>
#include <cstdint>
#include <string_view>

#include "core/time.hpp"

namespace scree::mapping {

enum class Stage : std::uint8_t { convert, fuse, look, roughness, elevation, shape, risk, publish };
inline constexpr std::size_t kStages = 8;
inline constexpr std::array<std::string_view, kStages> kStageNames = {"convert",   "fuse",  "look", "roughness",
                                                                      "elevation", "shape", "risk", "publish"};

/// Wall time of each stage.
struct StageTimes {
  std::array<Duration, kStages> of{};
  Duration operator[](Stage stage) const { return of[static_cast<std::size_t>(stage)]; }
};

/// Laps: each call books the time since the last one.
class StageClock {
 public:
  StageClock() : last_(MonotonicClock::now()) {}
  void lap(Stage stage) {
    const MonotonicTime now = MonotonicClock::now();
    times_.of[static_cast<std::size_t>(stage)] += std::chrono::duration_cast<Duration>(now - last_);
    last_ = now;
  }
  const StageTimes& times() const { return times_; }

 private:
  MonotonicTime last_;
  StageTimes times_;
};

}  // namespace scree::mapping
