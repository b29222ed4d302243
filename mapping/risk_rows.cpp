#include "mapping/risk_rows.hpp"

#include <algorithm>

#include "core/simd.hpp"
#include "fractal/lanes.hpp"

namespace scree::mapping::risk_rows {

namespace {

using Line = std::array<float, kBlock>;

/// Plane and steps under the vehicle, per cell.
struct Stand {
  alignas(64) Line level, along, across, step;
};

using OfWheels = std::array<const float*, Footprint::kWheels>;
using Weights = std::array<float, Footprint::kWheels>;

SCREE_INLINE float weighed(const Weights& weights, float a, float b, float c, float d) {
  return (weights[0] * a + weights[1] * b) + (weights[2] * c + weights[3] * d);
}

// Every row is an argument of its own: only there does g++ believe __restrict; of locals and of members it fears that
// they overlap and leaves the loop scalar, four times as slow (docs/mapping.md).
SCREE_CLONES void fit_plane(const float* __restrict z0, const float* __restrict z1, const float* __restrict z2,
                            const float* __restrict z3, const Weights& by_level, const Weights& by_along,
                            const Weights& by_across, int n, float* __restrict level, float* __restrict along,
                            float* __restrict across) {
  const Weights l = by_level, a = by_along, c = by_across;
  for (int i = 0; i < n; ++i) {
    level[i] = weighed(l, z0[i], z1[i], z2[i], z3[i]);
    along[i] = weighed(a, z0[i], z1[i], z2[i], z3[i]);
    across[i] = weighed(c, z0[i], z1[i], z2[i], z3[i]);
  }
}

SCREE_CLONES void largest(const float* __restrict s0, const float* __restrict s1, const float* __restrict s2,
                          const float* __restrict s3, int n, float* __restrict out) {
  for (int i = 0; i < n; ++i) {
    const float front = s0[i] > s1[i] ? s0[i] : s1[i], rear = s2[i] > s3[i] ? s2[i] : s3[i];
    out[i] = front > rear ? front : rear;
  }
}

/// Four places under the belly at a time: a pass is bound by what it loads (docs/mapping.md).
constexpr std::size_t kTogether = 4;
struct Places {
  std::array<const float*, kTogether> z;
  std::array<float, kTogether> along_m, across_m;
};

/// What stands above the plane at the places.
SCREE_CLONES void raise_belly(const Places& p, const Stand& stand, int n, float* __restrict best) {
  const float* __restrict z0 = p.z[0], * __restrict z1 = p.z[1], * __restrict z2 = p.z[2], * __restrict z3 = p.z[3];
  const float *__restrict level = stand.level.data(), *__restrict along = stand.along.data(),
              *__restrict across = stand.across.data();
  const auto x = p.along_m, y = p.across_m;
  for (int i = 0; i < n; ++i) {
    const float a = z0[i] - (x[0] * along[i] + y[0] * across[i]), b = z1[i] - (x[1] * along[i] + y[1] * across[i]);
    const float c = z2[i] - (x[2] * along[i] + y[2] * across[i]), d = z3[i] - (x[3] * along[i] + y[3] * across[i]);
    const float ab = a > b ? a : b, cd = c > d ? c : d, most = (ab > cd ? ab : cd) - level[i];
    best[i] = most > best[i] ? most : best[i];
  }
}

SCREE_CLONES void take_loads(const float* __restrict belly, const float* __restrict along,
                             const float* __restrict across, const float* __restrict step, Limits limits, int n,
                             float* __restrict sum, float* __restrict square, float* __restrict first,
                             float* __restrict second, float* __restrict violations) {
  for (int i = 0; i < n; ++i) {
    const float pitch = (along[i] < 0.0F ? -along[i] : along[i]) * limits.pitch;
    const float roll = (across[i] < 0.0F ? -across[i] : across[i]) * limits.roll;
    const float clearance = belly[i] * limits.clearance_m;
    const float tilt = pitch > roll ? pitch : roll, height = clearance > step[i] ? clearance : step[i];
    const float largest = tilt > height ? tilt : height, load = largest < limits.most ? largest : limits.most;
    const float beyond = (load - 1.0F) * limits.sharpness + 0.5F, some = beyond > 0.0F ? beyond : 0.0F;
    violations[i] += some < 1.0F ? some : 1.0F;
    sum[i] += load;
    square[i] += load * load;
    const float lower = load < first[i] ? load : first[i];
    first[i] = load > first[i] ? load : first[i];
    second[i] = lower > second[i] ? lower : second[i];
  }
}

}  // namespace

SCREE_CLONES void raise_difference(const float* here, const float* there, int n, float* best) {
  for (int i = 0; i < n; ++i) {
    const float d = there[i] > here[i] ? there[i] - here[i] : here[i] - there[i];
    best[i] = d > best[i] ? d : best[i];
  }
}

SCREE_CLONES void step_load(const float* relief_m2, float share, const float* face_m2, float scale, int n,
                            float* best) {
  for (int i = 0; i < n; ++i) {
    const float square = best[i] * best[i] + share * relief_m2[i] + face_m2[i];
    float log;  // a square root would call for errno and stay scalar
    fractal::fast_log<float, std::int32_t>(square + 1e-20F, log);
    best[i] = scale * fractal::fast_exp(0.5F * log);
  }
}

SCREE_CLONES void add_peaks(const float* __restrict draw_m, const float* __restrict relief_m2, float share,
                            const float* __restrict face_m2, int n, float* __restrict tops_m) {
  for (int i = 0; i < n; ++i) {
    float log;
    fractal::fast_log<float, std::int32_t>(share * relief_m2[i] + face_m2[i] + 1e-20F, log);
    tops_m[i] = draw_m[i] + fractal::fast_exp(0.5F * log);
  }
}

void add_loads(const Footprint& footprint, const Limits& limits, const Surface& surface, int row, int column, int n,
               Sums& sums) {
  const auto at = [&](const Grid<float>& grid, const Footprint::Part& part) {
    return grid.row(row + part.offset.y).data() + column + part.offset.x;
  };
  OfWheels z, step;
  for (std::size_t w = 0; w < footprint.wheels.size(); ++w) {
    z[w] = at(surface.draw_m, footprint.wheels[w]);
    step[w] = at(surface.step, footprint.wheels[w]);
  }
  Stand stand;
  fit_plane(z[0], z[1], z[2], z[3], footprint.level, footprint.along, footprint.across, n, stand.level.data(),
            stand.along.data(), stand.across.data());
  largest(step[0], step[1], step[2], step[3], n, stand.step.data());
  alignas(64) Line belly;
  std::fill_n(belly.begin(), n, 0.0F);
  for (std::size_t first = 0; first < footprint.belly.size(); first += kTogether) {
    Places places;
    for (std::size_t k = 0; k < kTogether; ++k) {  // the last place stands in for those that are missing
      const Footprint::Part& part = footprint.belly[std::min(first + k, footprint.belly.size() - 1)];
      places.z[k] = at(surface.tops_m, part);
      places.along_m[k] = part.along_m;
      places.across_m[k] = part.across_m;
    }
    raise_belly(places, stand, n, belly.data());
  }
  take_loads(belly.data(), stand.along.data(), stand.across.data(), stand.step.data(), limits, n, sums.sum.data(),
             sums.square.data(), sums.first.data(), sums.second.data(), sums.violations.data());
}

void raise_under_wheels(const Footprint& footprint, const Grid<float>& of, int row, int column, int n, float* best) {
  OfWheels under;
  for (std::size_t w = 0; w < footprint.wheels.size(); ++w) {
    const CellIndex& offset = footprint.wheels[w].offset;
    under[w] = of.row(row + offset.y).data() + column + offset.x;
  }
  alignas(64) Line most;
  largest(under[0], under[1], under[2], under[3], n, most.data());
  for (int i = 0; i < n; ++i) best[i] = std::max(best[i], most[static_cast<std::size_t>(i)]);
}

SCREE_CLONES void finish(const Sums& sums, int draws, float model_error, int n, float* __restrict probability,
                         float* __restrict worst, float* __restrict tail) {
  const auto k = static_cast<float>(draws);
  const float spread = (1.0F + 1.0F / k) * k / (k - 1.0F);
  const auto i_of = [](int i) { return static_cast<std::size_t>(i); };
  for (int i = 0; i < n; ++i) {
    const float mean = sums.sum[i_of(i)] / k;
    const float variance = sums.square[i_of(i)] / k - mean * mean;
    const float total = spread * (variance > 0.0F ? variance : 0.0F) + model_error * model_error;
    float log;
    fractal::fast_log<float, std::int32_t>(total, log);
    float z = (mean - 1.0F) * fractal::fast_exp(-0.5F * log);
    z = z < -6.0F ? -6.0F : z > 6.0F ? 6.0F : z;
    // Φ(z) to 2e-4: a logistic curve in z and z³ (Bowling et al. 2009)
    const float normal = 1.0F / (1.0F + fractal::fast_exp(-z * (1.5976F + 0.07056F * z * z)));
    const float share = sums.violations[i_of(i)] / k, p = normal > share ? normal : share;
    const float pair = 0.5F * (sums.first[i_of(i)] + sums.second[i_of(i)]);
    probability[i] = p;
    worst[i] = p > worst[i] ? p : worst[i];
    tail[i] = pair > tail[i] ? pair : tail[i];
  }
}

}  // namespace scree::mapping::risk_rows
