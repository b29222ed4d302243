#pragma once
// Intervals by drawing scenes again: what is near in space is alike, scenes are not.

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "core/random.hpp"
#include "tests/bench/map/report.hpp"

namespace scree::bench {

struct Interval {
  double value = 0.0, low = 0.0, high = 0.0;
};

/// statistic(scenes) of the scenes themselves with the middle 95 % of 400 resamplings of them; the same resamplings for
/// every statistic of one number of scenes, so that differences are paired. NaN results are left out.
template <class Scene, class Statistic>
Interval bootstrap(const std::vector<const Scene*>& scenes, const Statistic& statistic) {
  constexpr int kResamplings = 400;
  std::vector<double> values;
  std::vector<const Scene*> drawn(scenes.size());
  for (int k = 0; k < kResamplings; ++k) {
    for (std::size_t i = 0; i < drawn.size(); ++i)
      drawn[i] = scenes[random_words(1, 55, k, static_cast<std::int32_t>(i))[0] % scenes.size()];
    if (const double value = statistic(drawn); !std::isnan(value)) values.push_back(value);
  }
  std::sort(values.begin(), values.end());
  const auto at = [&](double q) {
    return values.empty() ? std::nan("") : values[static_cast<std::size_t>(q * static_cast<double>(values.size() - 1))];
  };
  return {statistic(scenes), at(0.025), at(0.975)};
}

inline std::string interval_text(const Interval& i, int digits = 3) {
  return fmt::format("{:.{}f} ({:.{}f}–{:.{}f})", i.value, digits, i.low, digits, i.high, digits);
}
inline std::string signed_interval_text(const Interval& i, int digits = 3) {
  return fmt::format("{:+.{}f} ({:+.{}f} … {:+.{}f})", i.value, digits, i.low, digits, i.high, digits);
}

}  // namespace scree::bench
