#include "drivers/frame/image_edges.hpp"

#include <limits>

#include "core/simd.hpp"

namespace scree {
namespace {

/// The rules of FilterConfig in float, ready for the inner loop.
struct EdgeRule {
  float ambiguity_m, half_ambiguity_m, intervals_per_m, max_wraps;
  float join_m, join_ratio, max_level_step_m;
  float noise_m, noise_per_m, noise_per_m2;  ///< bound of five standard deviations of a range difference
};

EdgeRule edge_rule(const RayTables& tables) {
  constexpr float kSigmas = 7.0711F;  // 5 · √2
  const SensorConfig& sensor = *tables.sensor;
  const float ambiguity = static_cast<float>(tables.projection->ambiguity_m);
  EdgeRule rule{};
  rule.ambiguity_m = ambiguity;
  rule.half_ambiguity_m = ambiguity > 0.0F ? 0.5F * ambiguity : std::numeric_limits<float>::infinity();
  rule.intervals_per_m = ambiguity > 0.0F ? 1.0F / ambiguity : 0.0F;
  rule.max_wraps = static_cast<float>(sensor.filter.max_wraps) + 0.5F;
  rule.max_level_step_m = 0.125F * rule.half_ambiguity_m;
  rule.join_m = static_cast<float>(sensor.filter.join_m);
  rule.join_ratio = static_cast<float>(sensor.filter.join_ratio);
  rule.noise_m = kSigmas * (static_cast<float>(sensor.noise.sigma_m) + 0.289F * tables.quantum_m);
  rule.noise_per_m = kSigmas * static_cast<float>(sensor.noise.sigma_per_m);
  rule.noise_per_m2 = kSigmas * static_cast<float>(sensor.noise.sigma_per_m2);
  return rule;
}

/// An ambiguous sensor tells the phase of the range only. Tolerances take the smallest reading, which joins less of
/// what is far; the step of level ground, without which far ground would fall apart, takes the reading nearest to that
/// ground, and at most a sixteenth of the ambiguity. Comparisons with NaN are false, so an edge to a missing pixel
/// comes out as 0 without a branch.
SCREE_CLONES void compare(const EdgeRule& rule, const float* here, const float* there, const float* grazing,
                          const float* level, const float* level_ground, int count, std::uint8_t* out) {
  for (int i = 0; i < count; ++i) {
    const float difference = there[i] - here[i];
    const int wraps =
        static_cast<int>(difference > rule.half_ambiguity_m) - static_cast<int>(difference < -rule.half_ambiguity_m);
    const float step = difference - static_cast<float>(wraps) * rule.ambiguity_m;
    const float range = here[i] < there[i] ? here[i] : there[i];
    float intervals = (level_ground[i] - range) * rule.intervals_per_m + 0.5F;
    intervals = intervals > 0.0F ? intervals : 0.0F;
    intervals = intervals < rule.max_wraps ? intervals : rule.max_wraps;
    const float unwrapped = range + static_cast<float>(static_cast<int>(intervals)) * rule.ambiguity_m;
    const float tolerance = rule.join_m + rule.join_ratio * range;
    const float level_step = level[i] * unwrapped;
    float low = level_step < 0.0F ? level_step : 0.0F;
    float high = level_step > 0.0F ? level_step : 0.0F;
    low = low > -rule.max_level_step_m ? low : -rule.max_level_step_m;
    high = high < rule.max_level_step_m ? high : rule.max_level_step_m;
    const float noise = rule.noise_m + unwrapped * (rule.noise_per_m + unwrapped * rule.noise_per_m2);
    const float grazing_step = grazing[i] * unwrapped;
    const float closeness = noise > grazing_step ? noise : grazing_step;
    const float magnitude = step < 0.0F ? -step : step;
    const float quarter = 0.25F * tolerance;
    const int joined = static_cast<int>(step >= low - tolerance) & static_cast<int>(step <= high + tolerance);
    const int tight = static_cast<int>(step >= low - quarter) & static_cast<int>(step <= high + quarter);
    const int close = static_cast<int>(magnitude <= closeness);
    const int present = static_cast<int>(difference == difference);
    const int bits = joined | (tight << 1) | (close << 2) | (present << 3) | ((wraps + 1) << edge::kWrapShift);
    out[i] = static_cast<std::uint8_t>(bits & -present);
  }
}

}  // namespace

void ImageEdges::compute(const Grid<float>& range_m, const RayTables& tables, Executor& executor) {
  const int rows = range_m.rows();
  const int columns = range_m.columns();
  if (right.rows() != rows || right.columns() != columns) {  // the last column and row have no edges and stay 0
    right.assign(rows, columns, 0);
    down.assign(rows, columns, 0);
  }
  const EdgeRule rule = edge_rule(tables);
  const bool ambiguous = tables.projection->ambiguity_m > 0.0;
  for_rows(executor, rows, [&](int begin, int end) {
    for (int r = begin; r < end; ++r) {
      const float* here = range_m.row(r).data();
      const float* level_ground = (ambiguous ? tables.level_ground_m : range_m).row(r).data();  // unused without wraps
      compare(rule, here, here + 1, tables.grazing_right.row(r).data(), tables.level_right.row(r).data(), level_ground,
              columns - 1, right.row(r).data());
      if (r + 1 < rows)
        compare(rule, here, range_m.row(r + 1).data(), tables.grazing_down.row(r).data(),
                tables.level_down.row(r).data(), level_ground, columns, down.row(r).data());
    }
  });
}

}  // namespace scree
