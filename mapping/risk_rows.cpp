#include "mapping/risk_rows.hpp"

#include <cmath>

#include "core/simd.hpp"
#include "fractal/lanes.hpp"

namespace scree::mapping::risk_rows {

namespace {

using Line = std::array<float, kBlock>;

struct Plane {
  alignas(64) Line level, along, across;
};

SCREE_CLONES void add_wheel(const float* __restrict z, float level, float along, float across, int n,
                            float* __restrict to_level, float* __restrict to_along, float* __restrict to_across) {
  for (int i = 0; i < n; ++i) {
    to_level[i] += level * z[i];
    to_along[i] += along * z[i];
    to_across[i] += across * z[i];
  }
}

SCREE_CLONES void raise(const float* __restrict value, int n, float* __restrict best) {
  for (int i = 0; i < n; ++i) best[i] = value[i] > best[i] ? value[i] : best[i];
}

/// What stands above the plane at one place under the belly.
SCREE_CLONES void raise_belly(const float* __restrict z, float along_m, float across_m, const float* __restrict level,
                              const float* __restrict along, const float* __restrict across, int n,
                              float* __restrict best) {
  for (int i = 0; i < n; ++i) {
    const float above = z[i] - (level[i] + along_m * along[i] + across_m * across[i]);
    best[i] = above > best[i] ? above : best[i];
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

SCREE_CLONES void step_load(const float* relief_m2, float scale, int n, float* best) {
  for (int i = 0; i < n; ++i) {
    const float square = best[i] * best[i] + relief_m2[i];
    float log;  // a square root would call for errno and stay scalar
    fractal::fast_log<float, std::int32_t>(square + 1e-20F, log);
    best[i] = scale * fractal::fast_exp(0.5F * log);
  }
}

void add_loads(const Footprint& footprint, const Limits& limits, const Grid<float>& draw_m, const Grid<float>& step,
               int row, int column, int n, Sums& sums) {
  Plane plane;
  alignas(64) Line belly, steps;
  for (auto* line : {&plane.level, &plane.along, &plane.across, &belly, &steps}) line->fill(0.0F);
  const auto at = [&](const Grid<float>& grid, const Footprint::Part& part) {
    return grid.row(row + part.offset.y).data() + column + part.offset.x;
  };
  for (std::size_t w = 0; w < footprint.wheels.size(); ++w) {
    add_wheel(at(draw_m, footprint.wheels[w]), footprint.level[w], footprint.along[w], footprint.across[w], n,
              plane.level.data(), plane.along.data(), plane.across.data());
    raise(at(step, footprint.wheels[w]), n, steps.data());
  }
  for (const Footprint::Part& part : footprint.belly)
    raise_belly(at(draw_m, part), part.along_m, part.across_m, plane.level.data(), plane.along.data(),
                plane.across.data(), n, belly.data());
  take_loads(belly.data(), plane.along.data(), plane.across.data(), steps.data(), limits, n, sums.sum.data(),
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
