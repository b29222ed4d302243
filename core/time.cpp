#include "core/time.hpp"

#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>

namespace scree {
namespace {

constexpr std::int64_t kNanosecondsPerSecond = 1'000'000'000;

Error not_seconds(std::string_view text) {
  return {ErrorKind::bad_data, "time: expected decimal seconds within ±9.2e9, found '" + std::string(text) + "'"};
}

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

/// Exponents are rare (Python's repr of small floats): go through a double.
Result<Duration> parse_with_exponent(std::string_view text) {
  double seconds = 0.0;
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), seconds);
  if (status != std::errc{} || end != text.data() + text.size() || !std::isfinite(seconds) || std::abs(seconds) > 9.2e9)
    return not_seconds(text);
  return from_seconds(seconds);
}

}  // namespace

Result<Duration> parse_seconds(std::string_view text) {
  if (text.find_first_of("eE") != std::string_view::npos) return parse_with_exponent(text);
  std::size_t i = 0;
  const bool negative = !text.empty() && text[0] == '-';
  if (negative || (!text.empty() && text[0] == '+')) ++i;

  std::int64_t whole = 0;
  const std::size_t first_digit = i;
  for (; i < text.size() && is_digit(text[i]); ++i) {
    whole = whole * 10 + (text[i] - '0');
    if (whole > 9'200'000'000) return not_seconds(text);
  }
  std::size_t digits = i - first_digit;

  std::int64_t fraction_ns = 0;
  if (i < text.size() && text[i] == '.') {
    std::int64_t unit = kNanosecondsPerSecond / 10;
    bool rounded = false;
    for (++i; i < text.size() && is_digit(text[i]); ++i, ++digits) {
      if (unit == 0 && !rounded) {  // the tenth decimal decides the rounding
        fraction_ns += text[i] >= '5' ? 1 : 0;
        rounded = true;
      }
      fraction_ns += (text[i] - '0') * unit;
      unit /= 10;
    }
  }
  if (i != text.size() || digits == 0) return not_seconds(text);
  const std::int64_t total = whole * kNanosecondsPerSecond + fraction_ns;
  return Duration(negative ? -total : total);
}

std::string format_seconds(Duration duration) {
  const std::int64_t total = duration.count();
  const std::uint64_t magnitude = total < 0 ? 0 - static_cast<std::uint64_t>(total) : static_cast<std::uint64_t>(total);
  char buffer[48];
  std::snprintf(buffer, sizeof buffer, "%s%llu.%09llu", total < 0 ? "-" : "",
                static_cast<unsigned long long>(magnitude / kNanosecondsPerSecond),
                static_cast<unsigned long long>(magnitude % kNanosecondsPerSecond));
  std::string text = buffer;
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text;
}

}  // namespace scree
