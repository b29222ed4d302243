#include "fractal/vecchia_profile.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "fractal/golden_section.hpp"

namespace scree::fractal {
namespace {

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

/// One lane's search over a coordinate u of τ. Noise known: u = log τ, f(u) = n·(log s² − u) + L'(u) + exp(log S(u) + u
/// − log s²). Unknown: u of FreeTau, f(u) = n·log(S(u)/n) + L'(u).
struct TauSearch {
  std::array<double, kMaxTaus> node{};
  std::array<Levelled, kMaxTaus> at{};
  std::size_t count = 0;
  double n = 0.0, log_noise = 0.0;
  bool unknown = false;

  double value(const Levelled& l, double u) const {
    if (unknown) return n * (l.log_s - std::log(n)) + l.log_det;
    return n * (log_noise - u) + l.log_det + std::exp(l.log_s + u - log_noise);
  }
  std::size_t best_node() const {
    std::size_t best = 0;
    for (std::size_t j = 1; j < count; ++j)
      if (value(at[j], node[j]) < value(at[best], node[best])) best = j;
    return best;
  }
  /// Through nodes [first, first + size).
  Levelled between(std::size_t first, std::size_t size, double u) const {
    const std::span<const double> nodes(node.data() + first, size);
    return {interpolate(
                nodes, [&](std::size_t i) { return at[first + i].log_s; }, u),
            interpolate(
                nodes, [&](std::size_t i) { return at[first + i].log_det; }, u)};
  }
};

/// Where the least value lies, and the sums there.
struct TauBest {
  double u, value;
  Levelled sums;
  double edge;
};

TauBest best_of(const TauSearch& search, bool close) {
  const std::size_t best = search.best_node(), last = search.count - 1;
  const std::size_t size = close ? search.count : 3;
  const std::size_t first = close ? 0 : std::min(best > 0 ? best - 1 : 0, search.count - size);
  const double low = search.node[best > 0 ? best - 1 : 0], high = search.node[std::min(best + 1, last)];
  const auto f = [&](double u) { return search.value(search.between(first, size, u), u); };
  TauBest out;
  out.u = golden_minimum(low, high, f);
  out.sums = search.between(first, size, out.u);
  out.value = search.value(out.sums, out.u);
  constexpr double kEdge = 1e-4;
  out.edge = out.u < search.node[0] + kEdge ? -1.0 : out.u > search.node[last] - kEdge ? 1.0 : 0.0;
  return out;
}

void search_tau(const TauSearch& search, bool close, std::size_t k, LaneProfile& out) {
  if (const double own = std::log(search.n) + search.log_noise - search.at[0].log_s;
      search.best_node() == 0 &&
      own < search.node[0]) {  // C from the sums themselves; they hardly depend on so small a τ
    out.log_tau[k] = own;
    out.minus_two_log[k] = search.n * (search.at[0].log_s - std::log(search.n)) + search.at[0].log_det + search.n;
    out.tau_edge[k] = -1.0;
    return;
  }
  const TauBest found = best_of(search, close);
  out.log_tau[k] = found.u;
  out.minus_two_log[k] = found.value;
  out.tau_edge[k] = found.edge;
}

}  // namespace

double contrast_count(std::size_t count) {
  return static_cast<double>(count) - 3.0;
}

LaneProfile clean_profile(const HurstLanes& lanes, const ErrorSums& sums, std::size_t count) {
  LaneProfile out{.lanes = lanes};
  const double n = contrast_count(count);
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
  TauSearch search{.count = taus.size(), .n = contrast_count(count), .log_noise = std::log(noise_variance)};
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

LaneProfile free_noise_profile(const HurstLanes& lanes, std::span<const PerLane> nodes, std::span<const ErrorSums> sums,
                               std::size_t count, bool close) {
  LaneProfile out{.lanes = lanes};
  TauSearch search{.count = nodes.size(), .n = contrast_count(count), .unknown = true};
  for (std::size_t k = 0; k < kHurstLanes; ++k) {
    for (std::size_t j = 0; j < nodes.size(); ++j) {
      search.node[j] = nodes[j][k];
      search.at[j] = levelled(sums[j], k);
    }
    const TauBest found = best_of(search, close);
    out.minus_two_log[k] = found.value;
    out.log_c[k] = found.sums.log_s - std::log(search.n);
    out.free_tau[k] = found.u;
    out.tau_edge[k] = found.edge < 0.0 && search.node[0] == 0.0 ? 0.0 : found.edge;
  }
  return out;
}

}  // namespace scree::fractal
