#include "io/log_axis.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace scree::io {

double LogRange::share(double value) const {
  return std::log(value / low) / std::log(high / low);
}

std::vector<Tick> log_ticks(const LogRange& range) {
  std::vector<Tick> result;
  const int first = static_cast<int>(std::floor(std::log10(range.low))),
            last = static_cast<int>(std::ceil(std::log10(range.high)));
  for (int n = first; n <= last; ++n)
    for (int digit = 1; digit <= 9; ++digit) {
      const double value = digit * std::pow(10.0, n);
      if (value >= range.low * (1 - 1e-9) && value <= range.high * (1 + 1e-9)) result.push_back({value, ""});
    }
  const auto digit_of = [](double value) {
    return static_cast<int>(std::lround(value / std::pow(10.0, std::floor(std::log10(value) + 1e-9))));
  };
  const auto label_where = [&](auto wanted) {
    int labels = 0;
    for (Tick& tick : result)
      if (wanted(digit_of(tick.value))) tick.label = fmt::format("{:.6g}", tick.value), ++labels;
    return labels;
  };
  if (label_where([](int digit) { return digit == 1; }) >= 3) return result;
  if (label_where([](int digit) { return digit == 1 || digit == 2 || digit == 5; }) >= 3) return result;
  label_where([](int) { return true; });
  return result;
}

LogRange widened(double low, double high, double share) {
  constexpr double kLeastRatio = 3.0;
  const double margin = std::max(share * std::log(high / low), 0.5 * (std::log(kLeastRatio) - std::log(high / low)));
  return {low * std::exp(-margin), high * std::exp(margin)};
}

}  // namespace scree::io
