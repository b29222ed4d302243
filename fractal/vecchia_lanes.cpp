#include "fractal/vecchia_lanes.hpp"

#include <algorithm>

#include "core/simd.hpp"
#include "fractal/wide_lanes.hpp"

namespace scree::fractal {
namespace {

constexpr int kM = kVecchiaNeighbours;
constexpr int kPairs = kM * (kM + 1) / 2;
constexpr int kPairsPadded = (kPairs + 7) / 8 * 8;
constexpr int kHalves = kHurstLanes / 8;
constexpr int kLogEvery = 8;  // points whose variances are multiplied before a logarithm is taken

/// Entry of node a ≥ 1 and node b < a. Node 0 is the reference (the nearest predecessor), the others predecessors,
/// the last the point itself.
constexpr int pair(int a, int b) {
  return a * (a - 1) / 2 + b;
}

using PairValues = std::array<double, kPairsPadded>;
using PairLanes = std::array<WideLanes, kPairs>;
struct Nodes {
  std::array<const VecchiaPoint*, kM + 1> at;
  int last;  // index of the point itself
};

SCREE_INLINE void choose_nodes(std::span<const VecchiaPoint> points, const Predecessors& before, std::size_t i,
                               Nodes& nodes) {
  nodes.last = static_cast<int>(std::min<std::size_t>(i, kM));
  for (int a = 0; a < nodes.last; ++a)
    nodes.at[static_cast<std::size_t>(a)] = &points[static_cast<std::size_t>(before[static_cast<std::size_t>(a)])];
  nodes.at[static_cast<std::size_t>(nodes.last)] = &points[i];
}

/// log2 of the squared distances; 0 beyond the pairs.
SCREE_INLINE void log_distances(const Nodes& nodes, PairValues& out) {
  out.fill(1.0);
  for (int a = 1, at = 0; a <= nodes.last; ++a)
    for (int b = 0; b < a; ++b, ++at) {
      const auto &p = *nodes.at[static_cast<std::size_t>(a)], &q = *nodes.at[static_cast<std::size_t>(b)];
      const double dx = p.x - q.x, dy = p.y - q.y;
      out[static_cast<std::size_t>(at)] = dx * dx + dy * dy;
    }
  for (std::size_t at = 0; at < kPairsPadded; at += 8) {
    WideLanes value;
    load(&out[at], value);
    log2_of(value, value);
    store(value, &out[at]);
  }
}

SCREE_INLINE void powers(const PairValues& log2_r2, double exponent, PairValues& out) {
  for (std::size_t at = 0; at < kPairsPadded; at += 8) {
    WideLanes value;
    load(&log2_r2[at], value);
    value = value * exponent;
    exp2_of(value, value);
    store(value, &out[at]);
  }
}

/// γ at every lane: the lanes' H are equally spaced, so r^2H is a geometric series of ratio r^(2·step).
SCREE_INLINE void variograms(const PairValues& first, const PairValues& ratio, int half, int pairs, PairLanes& out) {
  const WideLanes one = {1, 1, 1, 1, 1, 1, 1, 1};
  constexpr WideWords kOdd = {0, ~0ULL, 0, ~0ULL, 0, ~0ULL, 0, ~0ULL};
  constexpr WideWords kPair = {0, 0, ~0ULL, ~0ULL, 0, 0, ~0ULL, ~0ULL};
  constexpr WideWords kFour = {0, 0, 0, 0, ~0ULL, ~0ULL, ~0ULL, ~0ULL};
  for (int at = 0; at < pairs; ++at) {
    const double q = ratio[static_cast<std::size_t>(at)], q2 = q * q, q4 = q2 * q2;
    const double base =
        half == 0 ? first[static_cast<std::size_t>(at)] : first[static_cast<std::size_t>(at)] * (q4 * q4);
    const WideLanes w1 = one * q, w2 = one * q2, w4 = one * q4;
    out[static_cast<std::size_t>(at)] = ((kOdd ? w1 : one) * (kPair ? w2 : one)) * ((kFour ? w4 : one) * base);
  }
}

/// From variograms to half the covariances of the differences from the reference, whose noise-free part is
/// A_ab = (γ_a0 + γ_b0 − γ_ab)/2, A_aa = γ_a0; in place, from the last row up.
SCREE_INLINE void covariances(int last, PairLanes& g) {
  for (int a = last; a >= 2; --a)
    for (int b = a - 1; b >= 1; --b)
      g[static_cast<std::size_t>(pair(a, b))] =
          0.5 * (g[static_cast<std::size_t>(pair(a, 0))] + g[static_cast<std::size_t>(pair(b, 0))] -
                 g[static_cast<std::size_t>(pair(a, b))]);
}

/// Sums of one τ and one half of the lanes in registers' form.
struct HalfSums {
  WideLanes zz = {}, zx = {}, zy = {}, xx = {}, xy = {}, yy = {}, log_v = {};
  WideLanes product = {1, 1, 1, 1, 1, 1, 1, 1};

  SCREE_INLINE void take_log() {
    WideLanes logarithm;
    log2_of(product, logarithm);
    log_v = log_v + logarithm * 0.69314718055994531;
    product = WideLanes{} + 1.0;
  }
};

/// A + noise = L·D·Lᵀ of the predecessors bordered by the point itself. The last row of L holds the weights on the
/// prediction errors of the predecessors, the last of D the variance of the point's own; L's transpose turns the first
/// into kriging weights.
template <int kFixedLast>
SCREE_INLINE void add_point(const Nodes& nodes, const PairLanes& a, const WideLanes& tau, HalfSums& sums) {
  const int last = kFixedLast > 0 ? kFixedLast : nodes.last;
  const WideLanes common = tau * nodes.at[0]->noise_share;
  std::array<WideLanes, kPairs> l;
  WideLanes inverse = {}, least;
  WideLanes variance = {};
  for (int j = 1; j <= last; ++j) {  // column j of L
    const WideLanes diagonal =
        a[static_cast<std::size_t>(pair(j, 0))] + (common + tau * nodes.at[static_cast<std::size_t>(j)]->noise_share);
    variance = diagonal;
    // l(j,k) still holds L·D for k < j (rows are scaled when their column is left): D_jj = A_jj − Σ (LD)²/D.
    for (int k = 1; k < j; ++k) {
      const auto jk = static_cast<std::size_t>(pair(j, k));
      const WideLanes unscaled = l[jk];
      l[jk] = unscaled * l[static_cast<std::size_t>(pair(k, 0))];
      variance = variance - unscaled * l[jk];
    }
    least = diagonal * 1e-13;
    variance = variance > least ? variance : least;
    inverse = 1.0 / variance;
    l[static_cast<std::size_t>(pair(j, 0))] = inverse;
    for (int i = j + 1; i <= last; ++i) {  // (LD)_ij = A_ij − Σ (LD)_ik L_jk
      WideLanes s = a[static_cast<std::size_t>(pair(i, j))] + common;
      for (int k = 1; k < j; ++k)
        s = s - l[static_cast<std::size_t>(pair(i, k))] * l[static_cast<std::size_t>(pair(j, k))];
      l[static_cast<std::size_t>(pair(i, j))] = s;
    }
  }

  const VecchiaPoint &reference = *nodes.at[0], &point = *nodes.at[static_cast<std::size_t>(last)];
  const WideLanes zero = {};
  WideLanes ez = zero + (point.z - reference.z), ex = zero + (point.x - reference.x),
            ey = zero + (point.y - reference.y);
  for (int j = last - 1; j >= 1; --j) {  // kriging weights, by back substitution in place of the last row
    const WideLanes weight = l[static_cast<std::size_t>(pair(last, j))];
    for (int k = 1; k < j; ++k) {
      auto& entry = l[static_cast<std::size_t>(pair(last, k))];
      entry = entry - weight * l[static_cast<std::size_t>(pair(j, k))];
    }
    const VecchiaPoint& p = *nodes.at[static_cast<std::size_t>(j)];
    ez = ez - weight * (p.z - reference.z);
    ex = ex - weight * (p.x - reference.x);
    ey = ey - weight * (p.y - reference.y);
  }
  const WideLanes wz = ez * inverse, wx = ex * inverse;
  sums.zz = sums.zz + wz * ez;
  sums.zx = sums.zx + wz * ex;
  sums.zy = sums.zy + wz * ey;
  sums.xx = sums.xx + wx * ex;
  sums.xy = sums.xy + wx * ey;
  sums.yy = sums.yy + (ey * inverse) * ey;
  sums.product = sums.product * variance;
}

SCREE_INLINE void add_half(const WideLanes& from, PerLane& to, int half) {
  WideLanes value;
  load(&to[static_cast<std::size_t>(8 * half)], value);
  value = value + from;
  store(value, &to[static_cast<std::size_t>(8 * half)]);
}

struct TauSums {
  std::array<WideLanes, kHalves> tau;
  std::array<HalfSums, kHalves> half;
};

}  // namespace

SCREE_CLONES void add_errors(std::span<const VecchiaPoint> points, std::span<const Predecessors> predecessors,
                             const HurstLanes& lanes, std::span<const PerLane> taus, std::span<ErrorSums> sums) {
  std::array<TauSums, kMaxTaus> work;
  for (std::size_t t = 0; t < taus.size(); ++t)
    for (int h = 0; h < kHalves; ++h) {
      load(&taus[t][static_cast<std::size_t>(8 * h)], work[t].tau[static_cast<std::size_t>(h)]);
      work[t].half[static_cast<std::size_t>(h)] = HalfSums{};
    }
  for (std::size_t i = 1; i < points.size(); ++i) {
    Nodes nodes;
    choose_nodes(points, predecessors[i], i, nodes);
    PairValues log2_r2, first, ratio;
    log_distances(nodes, log2_r2);
    powers(log2_r2, lanes.first, first);
    powers(log2_r2, lanes.step, ratio);
    for (int h = 0; h < kHalves; ++h) {
      PairLanes a;
      variograms(first, ratio, h, pair(nodes.last + 1, 0), a);
      covariances(nodes.last, a);
      for (std::size_t t = 0; t < taus.size(); ++t) {
        auto& half = work[t].half[static_cast<std::size_t>(h)];
        const auto& tau = work[t].tau[static_cast<std::size_t>(h)];
        if (nodes.last == kM)
          add_point<kM>(nodes, a, tau, half);
        else
          add_point<0>(nodes, a, tau, half);
        if (i % kLogEvery == 0) half.take_log();
      }
    }
  }
  for (std::size_t t = 0; t < taus.size(); ++t)
    for (int h = 0; h < kHalves; ++h) {
      auto& half = work[t].half[static_cast<std::size_t>(h)];
      half.take_log();
      add_half(half.zz, sums[t].zz, h);
      add_half(half.zx, sums[t].zx, h);
      add_half(half.zy, sums[t].zy, h);
      add_half(half.xx, sums[t].xx, h);
      add_half(half.xy, sums[t].xy, h);
      add_half(half.yy, sums[t].yy, h);
      add_half(half.log_v, sums[t].log_v, h);
    }
}

}  // namespace scree::fractal
