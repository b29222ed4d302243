// The minimum of a profile over H, and its interval.

#include <algorithm>
#include <cmath>

#include "fractal/golden_section.hpp"
#include "fractal/vecchia_profile.hpp"

namespace scree::fractal {
namespace {

constexpr double kChiSquare95 = 3.841458820694124;

}  // namespace

double between_lanes(const PerLane& values, double lane) {
  const double at = std::clamp(lane, 0.0, static_cast<double>(kHurstLanes - 1));
  const int first = std::clamp(static_cast<int>(at) - 1, 0, kHurstLanes - 4);
  const double t = at - first;  // cubic of Lagrange at 0, 1, 2, 3
  const double* v = values.data() + first;
  return -v[0] * (t - 1) * (t - 2) * (t - 3) / 6.0 + v[1] * t * (t - 2) * (t - 3) / 2.0 -
         v[2] * t * (t - 1) * (t - 3) / 2.0 + v[3] * t * (t - 1) * (t - 2) / 6.0;
}

HurstFit fit_hurst(const LaneProfile& profile) {
  const auto& f = profile.minus_two_log;
  const auto at = [&](double lane) { return between_lanes(f, lane); };
  constexpr double kLast = kHurstLanes - 1;
  const auto best = static_cast<double>(std::min_element(f.begin(), f.end()) - f.begin());
  HurstFit fit;
  fit.lane = golden_minimum(std::max(best - 1.0, 0.0), std::min(best + 1.0, kLast), at);
  if (at(best) < at(fit.lane)) fit.lane = best;
  fit.hurst = profile.lanes.at(fit.lane);

  const auto middle = static_cast<std::size_t>(std::clamp(best, 1.0, kLast - 1.0));
  const double curvature = 0.5 * (f[middle - 1] - 2.0 * f[middle] + f[middle + 1]);  // per squared lane
  if (curvature > 0.0) fit.sigma = std::min(profile.lanes.step / std::sqrt(curvature), 0.25);

  const double target = at(fit.lane) + kChiSquare95;
  /// Walks from the minimum to where f passes the target, then bisects.
  const auto crossing = [&](double direction, bool& open) {
    constexpr double kStride = 0.25;
    double inside = fit.lane, outside = fit.lane;
    do {
      inside = outside;
      outside = std::clamp(inside + direction * kStride, 0.0, kLast);
      if (outside == inside) {
        open = true;
        return outside;
      }
    } while (at(outside) < target);
    for (int i = 0; i < 40; ++i) {
      const double half = 0.5 * (inside + outside);
      (at(half) < target ? inside : outside) = half;
    }
    return 0.5 * (inside + outside);
  };
  fit.low = profile.lanes.at(crossing(-1.0, fit.low_open));
  fit.high = profile.lanes.at(crossing(1.0, fit.high_open));
  if (fit.low_open != fit.high_open)  // no parabola about a bound: the side that the data close says how sure they are
    fit.sigma = (fit.low_open ? fit.high - fit.hurst : fit.hurst - fit.low) / std::sqrt(kChiSquare95);
  return fit;
}

}  // namespace scree::fractal
