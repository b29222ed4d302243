#pragma once
// Clock types. Time is a chrono type everywhere; seconds as decimal text exist only in files.

#include <chrono>
#include <string>
#include <string_view>

#include "core/result.hpp"

namespace scree {

using Duration = std::chrono::nanoseconds;

/// Time of data: nanoseconds since the Unix epoch, or since a recording's own zero.
using Time = std::chrono::sys_time<Duration>;

/// Ages and latencies are measured on this clock.
using MonotonicClock = std::chrono::steady_clock;
using MonotonicTime = MonotonicClock::time_point;

/// Decimal seconds ("12", "-0.5", "1699999999.123456789", "1e-3") to nanoseconds, exact for up to nine decimals (a
/// tenth rounds half up). Fails on anything else, and beyond ±9.2e9 s.
Result<Duration> parse_seconds(std::string_view text);

/// Nanoseconds to the shortest decimal seconds that parse_seconds reads back to the same value.
std::string format_seconds(Duration duration);

/// For arithmetic that needs a number (interpolation weights, speeds), never for storing a time.
inline double to_seconds(Duration duration) {
  return std::chrono::duration<double>(duration).count();
}

/// Nearest nanosecond; `seconds` must be finite and |seconds| < 9.2e9.
inline Duration from_seconds(double seconds) {
  return std::chrono::round<Duration>(std::chrono::duration<double>(seconds));
}

}  // namespace scree
