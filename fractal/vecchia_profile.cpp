#include "fractal/vecchia_profile.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace scree::fractal {
namespace {

constexpr double kChiSquare95 = 3.841458820694124;

/// Sums of one lane and τ with the plane at its generalised least squares.
struct Levelled {
  double log_s;    // of the residual quadratic form
  double log_det;  // Σ log v + log of the plane's information
};

Levelled levelled(const ErrorSums& sums, std::size_t k) {
  const double det = sums.xx[k] * sums.yy[k] - sums.xy[k] * sums.xy[k];
  const double a = (sums.zx[k] * sums.yy[k] - sums.zy[k] * sums.xy[k]) / det;
  const double b = (sums.zy[k] * sums.xx[k] - sums.zx[k] * sums.xy[k]) / det;
  const double s = sums.zz[k] - a * sums.zx[k] - b * sums.zy[k];
  return {std::log(std::max(s, std::numeric_limits<double>::min())), sums.log_v[k] + std::log(det)};
}

/// One point gives the level, two the plane.
double contrasts(std::size_t count) {
  return static_cast<double>(count) - 3.0;
}

/// Polynomial through the nodes (Neville).
template <class Value>
double interpolate(std::span<const double> nodes, Value value, double at) {
  std::array<double, kMaxTaus> p{};
  const std::size_t n = nodes.size();
  for (std::size_t i = 0; i < n; ++i) p[i] = value(i);
  for (std::size_t order = 1; order < n; ++order)
    for (std::size_t i = 0; i + order < n; ++i)
      p[i] = ((at - nodes[i + order]) * p[i] + (nodes[i] - at) * p[i + 1]) / (nodes[i] - nodes[i + order]);
  return p[0];
}

template <class Function>
double golden_minimum(double low, double high, Function f) {
  constexpr double kGolden = 0.6180339887498949, kTolerance = 1e-7;
  double a = high - kGolden * (high - low), b = low + kGolden * (high - low);
  double fa = f(a), fb = f(b);
  while (high - low > kTolerance) {
    if (fa < fb) {
      high = b, b = a, fb = fa;
      fa = f(a = high - kGolden * (high - low));
    } else {
      low = a, a = b, fa = fb;
      fb = f(b = low + kGolden * (high - low));
    }
  }
  return 0.5 * (low + high);
}

/// One lane's search over log τ = u: f(u) = n·(log s² − u) + L'(u) + exp(log S(u) + u − log s²).
struct TauSearch {
  std::array<double, kMaxTaus> node{};
  std::array<Levelled, kMaxTaus> at{};
  std::size_t count = 0;
  double n = 0.0, log_noise = 0.0;

  double value(const Levelled& l, double u) const {
    return n * (log_noise - u) + l.log_det + std::exp(l.log_s + u - log_noise);
  }
  std::size_t best_node() const {
    std::size_t best = 0;
    for (std::size_t j = 1; j < count; ++j)
      if (value(at[j], node[j]) < value(at[best], node[best])) best = j;
    return best;
  }
  /// Through nodes [first, first + size).
  double between(std::size_t first, std::size_t size, double u) const {
    const std::span<const double> nodes(node.data() + first, size);
    const Levelled l{interpolate(
                         nodes, [&](std::size_t i) { return at[first + i].log_s; }, u),
                     interpolate(
                         nodes, [&](std::size_t i) { return at[first + i].log_det; }, u)};
    return value(l, u);
  }
};

void search_tau(const TauSearch& search, bool close, std::size_t k, LaneProfile& out) {
  const std::size_t best = search.best_node(), last = search.count - 1;
  if (const double own = std::log(search.n) + search.log_noise - search.at[0].log_s;
      best == 0 && own < search.node[0]) {  // C from the sums themselves; they hardly depend on so small a τ
    out.log_tau[k] = own;
    out.minus_two_log[k] = search.n * (search.at[0].log_s - std::log(search.n)) + search.at[0].log_det + search.n;
    out.tau_edge[k] = -1.0;
    return;
  }
  const std::size_t size = close ? search.count : 3;
  const std::size_t first = close ? 0 : std::min(best > 0 ? best - 1 : 0, search.count - size);
  const double low = search.node[best > 0 ? best - 1 : 0], high = search.node[std::min(best + 1, last)];
  const auto f = [&](double u) { return search.between(first, size, u); };
  out.log_tau[k] = golden_minimum(low, high, f);
  out.minus_two_log[k] = f(out.log_tau[k]);
  constexpr double kEdge = 1e-4;
  out.tau_edge[k] = out.log_tau[k] < search.node[0] + kEdge      ? -1.0
                    : out.log_tau[k] > search.node[last] - kEdge ? 1.0
                                                                 : 0.0;
}

}  // namespace

LaneProfile clean_profile(const HurstLanes& lanes, const ErrorSums& sums, std::size_t count) {
  LaneProfile out{.lanes = lanes};
  const double n = contrasts(count);
  for (std::size_t k = 0; k < kHurstLanes; ++k) {
    const Levelled l = levelled(sums, k);
    out.log_c[k] = l.log_s - std::log(n);
    out.minus_two_log[k] = n * out.log_c[k] + l.log_det;
  }
  return out;
}

LaneProfile noisy_profile(const HurstLanes& lanes, std::span<const PerLane> taus, std::span<const ErrorSums> sums,
                          std::size_t count, double noise_variance, bool close) {
  LaneProfile out{.lanes = lanes};
  TauSearch search{.count = taus.size(), .n = contrasts(count), .log_noise = std::log(noise_variance)};
  for (std::size_t k = 0; k < kHurstLanes; ++k) {
    for (std::size_t j = 0; j < taus.size(); ++j) {
      search.node[j] = std::log(taus[j][k]);
      search.at[j] = levelled(sums[j], k);
    }
    search_tau(search, close, k, out);
    out.log_c[k] = search.log_noise - out.log_tau[k];
  }
  return out;
}

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
  return fit;
}

}  // namespace scree::fractal
