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

struct Wheels {
  std::array<const float*, Footprint::kWheels> z, step;
  std::array<float, Footprint::kWheels> level, along, across;
};

SCREE_INLINE float weighed(const std::array<float, Footprint::kWheels>& weights, float a, float b, float c, float d) {
  return (weights[0] * a + weights[1] * b) + (weights[2] * c + weights[3] * d);
}

// Pointers of its own for every row: through the structs the compiler sees aliases and leaves the loop scalar.
SCREE_CLONES void stand_on(const Wheels& w, int n, Stand& out) {
  const float* __restrict z0 = w.z[0], * __restrict z1 = w.z[1], * __restrict z2 = w.z[2], * __restrict z3 = w.z[3];
  const float* __restrict s0 = w.step[0], * __restrict s1 = w.step[1], * __restrict s2 = w.step[2], * __restrict s3 = w.step[3];
  float *__restrict level = out.level.data(), *__restrict along = out.along.data(),
        *__restrict across = out.across.data(), *__restrict step = out.step.data();
  const auto by_level = w.level, by_along = w.along, by_across = w.across;
  for (int i = 0; i < n; ++i) {
    level[i] = weighed(by_level, z0[i], z1[i], z2[i], z3[i]);
    along[i] = weighed(by_along, z0[i], z1[i], z2[i], z3[i]);
    across[i] = weighed(by_across, z0[i], z1[i], z2[i], z3[i]);
    const float front = s0[i] > s1[i] ? s0[i] : s1[i], rear = s2[i] > s3[i] ? s2[i] : s3[i];
    step[i] = front > rear ? front : rear;
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
                             float* __restrict second) {
  for (int i = 0; i < n; ++i) {
    const float pitch = (along[i] < 0.0F ? -along[i] : along[i]) * limits.pitch;
    const float roll = (across[i] < 0.0F ? -across[i] : across[i]) * limits.roll;
    const float clearance = belly[i] * limits.clearance_m;
    const float tilt = pitch > roll ? pitch : roll, height = clearance > step[i] ? clearance : step[i];
    const float load = tilt > height ? tilt : height;
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

SCREE_CLONES void add_peaks(const float* draw_m, const float* relief_m2, float factor, int n, float* tops_m) {
  for (int i = 0; i < n; ++i) {
    float log;
    fractal::fast_log<float, std::int32_t>(relief_m2[i] + 1e-20F, log);
    tops_m[i] = draw_m[i] + factor * fractal::fast_exp(0.5F * log);
  }
}

void add_loads(const Footprint& footprint, const Limits& limits, const Surface& surface, int row, int column, int n,
               Sums& sums) {
  const auto at = [&](const Grid<float>& grid, const Footprint::Part& part) {
    return grid.row(row + part.offset.y).data() + column + part.offset.x;
  };
  Wheels wheels{{}, {}, footprint.level, footprint.along, footprint.across};
  for (std::size_t w = 0; w < footprint.wheels.size(); ++w) {
    wheels.z[w] = at(surface.draw_m, footprint.wheels[w]);
    wheels.step[w] = at(surface.step, footprint.wheels[w]);
  }
  Stand stand;
  stand_on(wheels, n, stand);
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
             sums.square.data(), sums.first.data(), sums.second.data());
}

SCREE_CLONES void finish(const Sums& sums, int draws, float model_error, int n, float* probability, float* worst,
                         float* tail) {
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
    const float p = 1.0F / (1.0F + fractal::fast_exp(-z * (1.5976F + 0.07056F * z * z)));
    const float pair = 0.5F * (sums.first[i_of(i)] + sums.second[i_of(i)]);
    probability[i] = p;
    worst[i] = p > worst[i] ? p : worst[i];
    tail[i] = pair > tail[i] ? pair : tail[i];
  }
}

}  // namespace scree::mapping::risk_rows
