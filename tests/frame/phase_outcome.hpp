#pragma once
// Resolved ranges against the truth of their pixels, and the scenes that tests and the study share.

#include <cmath>
#include <cstdint>
#include <utility>

#include "tests/frame/scanned_scene.hpp"

namespace scree::test {

struct PhaseOutcome {
  PointFrame points;
  int wrong = 0;          ///< points farther than 1 m along the ray from the truth of their pixel
  bool complete = false;  ///< converted, and every point was found in its row again
};

/// Converts and holds every point against the truth of its pixel, which is found again by its phase.
inline PhaseOutcome convert_and_compare(const Scan& scan, const GroundLookup& ground) {
  PhaseOutcome out;
  SerialExecutor executor;
  out.complete = static_cast<bool>(PointConverter().convert(scan.frame, ground, executor, out.points));
  const Projection& p = *scan.frame.projection;
  for (int r = 0; out.complete && r < p.rows; ++r) {
    std::uint32_t i = out.points.row_begin[static_cast<std::size_t>(r)];
    const std::uint32_t end = out.points.row_begin[static_cast<std::size_t>(r) + 1];
    for (int c = 0; c < p.columns && i < end; ++c) {  // points keep the order of the columns; wraps cost no phase
      const float wraps = (out.points.range_m[i] - scan.frame.range_m(r, c)) / static_cast<float>(p.ambiguity_m);
      if (!(std::abs(wraps - std::round(wraps)) < 1e-4F)) continue;
      out.wrong += std::abs(out.points.range_m[i] - scan.truth_m(r, c)) > 1.0F ? 1 : 0;
      ++i;
    }
    out.complete = i == end;
  }
  return out;
}

/// Pixels whose surface is at most `range_m` away.
inline std::uint64_t pixels_within(const Scan& scan, float range_m) {
  std::uint64_t count = 0;
  for (const float truth : scan.truth_m) count += truth <= range_m ? 1U : 0U;
  return count;
}

inline std::uint64_t points_within(const PointFrame& points, float range_m) {
  std::uint64_t count = 0;
  for (const float range : points.range_m) count += range <= range_m ? 1U : 0U;
  return count;
}

/// A square building whose walls stand at random; seeds differ in place, size and yaw.
inline Scene random_building(std::uint64_t seed) {
  const auto u = random_words(seed, 1, 0, 0);
  const double x = 3.0 + 14.0 * to_uniform(u[0]);
  const double y = -5.0 + 10.0 * to_uniform(u[1]);
  const double height = 0.4 + 3.0 * to_uniform(u[2]);
  const double yaw = 3.14 * to_uniform(u[3]);
  const Eigen::Vector3d normal(-std::cos(yaw), std::sin(yaw), 0.0);
  return part(plane({x, y, 0}, normal), [=](const auto& p) {
    return p.z() >= 0.0 && p.z() < height && (p - Eigen::Vector3d(x, y, p.z())).norm() < 2.0;
  });
}

/// Three of them.
inline Scene random_walls(std::uint64_t seed) {
  return nearest(random_building(3 * seed), nearest(random_building(3 * seed + 1), random_building(3 * seed + 2)));
}

}  // namespace scree::test
