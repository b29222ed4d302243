#include "drivers/frame/phase_evidence.hpp"

#include <cmath>

namespace scree {
namespace {

constexpr int kMapPixelsPerSurface = 1024;  // lookups cost more than arithmetic: large surfaces are sampled

struct MapPoint {
  Eigen::Vector3d position_m;
  double height_variance_m2;
};

/// A candidate in the map frame. Its height errs along the ray, and by where the ground would be met on a slope.
MapPoint map_point(const RayTables& tables, const RowPoses& poses, int row, std::size_t i, float range_m) {
  const Projection& p = *tables.projection;
  const RowPose& pose = poses.rows[static_cast<std::size_t>(row)];
  const Eigen::Vector3f direction =
      pose.rotation * Eigen::Vector3f(p.direction_x[i], p.direction_y[i], p.direction_z[i]);
  const Eigen::Vector3f origin =
      pose.rotation * Eigen::Vector3f(p.origin_x_m[i], p.origin_y_m[i], p.origin_z_m[i]) + pose.origin_m;
  const Eigen::Vector3f local = origin + range_m * direction;
  const double variance = range_variance_m2(tables.sensor->noise, range_m, p.range_per_count_m[i]);
  const double slope = std::tan(tables.sensor->filter.anchor_slope_rad);
  const double down = direction.z();
  const double across = slope * std::hypot(direction.x(), direction.y());
  return {poses.anchor_map_m + local.cast<double>(), variance * (down * down + across * across)};
}

/// The same in the body frame of the pixel's own row.
Eigen::Vector3f body_point(const RayTables& tables, const Eigen::Matrix3f& rotation, std::size_t i, float range_m) {
  const Projection& p = *tables.projection;
  const Eigen::Vector3f direction(p.direction_x[i], p.direction_y[i], p.direction_z[i]);
  const Eigen::Vector3f origin(p.origin_x_m[i], p.origin_y_m[i], p.origin_z_m[i]);
  return rotation * (origin + range_m * direction) + tables.sensor->T_body_sensor.translation_m.cast<float>();
}

}  // namespace

void PlaneSums::add(const Eigen::Vector3f& point_m) {
  const double px = point_m.x();
  const double py = point_m.y();
  const double pz = point_m.z();
  n += 1.0;
  x += px;
  y += py;
  z += pz;
  xx += px * px;
  xy += px * py;
  yy += py * py;
  xz += px * pz;
  yz += py * pz;
}

double PlaneSums::slope() const {
  const double sxx = xx - x * x / n;
  const double sxy = xy - x * y / n;
  const double syy = yy - y * y / n;
  const double sxz = xz - x * z / n;
  const double syz = yz - y * z / n;
  const double area = sxx * syy - sxy * sxy;
  if (!(area > 1e-6 * (sxx + syy) * (sxx + syy))) return 0.0;
  return std::hypot(sxz * syy - syz * sxy, syz * sxx - sxz * sxy) / area;
}

void PhaseEvidence::collect(const RayTables& tables, const RowPoses& poses, const GroundLookup& ground,
                            const Surfaces& surfaces, const Grid<PixelState>& state, const Grid<float>& range_m) {
  surfaces_.clear();
  index_of_root_.assign(state.size(), -1);
  vote_.assign(state.size(), static_cast<std::int8_t>(kNoVote));
  body_rotation_ = tables.sensor->T_body_sensor.rotation.toRotationMatrix().cast<float>();
  std::size_t i = 0;
  for (int row = 0; row < state.rows(); ++row)
    for (int column = 0; column < state.columns(); ++column, ++i) {
      if (state[i] != PixelState::kept) continue;
      SurfaceEvidence& evidence = evidence_of(surfaces, surfaces.root(i));
      const int relative = surfaces.wraps(i);
      vote_by_ground(tables, i, range_m[i], relative, evidence);
      const int stride = 1 + evidence.size / kMapPixelsPerSurface;
      if (ground && evidence.visited++ % stride == 0)
        vote_by_map(tables, poses, ground, row, i, range_m[i], relative, evidence);
    }
}

SurfaceEvidence& PhaseEvidence::evidence_of(const Surfaces& surfaces, std::int32_t root) {
  if (index_of_root_[root] < 0) {
    index_of_root_[root] = static_cast<std::int32_t>(surfaces_.size());
    SurfaceEvidence fresh;
    fresh.root = root;
    fresh.size = surfaces.size(root);
    fresh.twisted = surfaces.twisted(root);
    surfaces_.push_back(fresh);
  }
  return surfaces_[surface_of(root)];
}

/// RayTables made sure that at most one candidate fits between near and far, and that no other is possible then.
void PhaseEvidence::vote_by_ground(const RayTables& tables, std::size_t i, float range_m, int relative,
                                   SurfaceEvidence& evidence) {
  const float near = tables.ground_near_m[i];
  const float far = tables.ground_far_m[i];
  if (near > far) return;
  const bool anchors = tables.anchors(i);
  evidence.asked += anchors ? 1 : 0;
  const float ambiguity = static_cast<float>(tables.projection->ambiguity_m);
  for (int k = kFirstCandidate; k <= 1; ++k) {
    const float candidate_m = range_m + static_cast<float>(k) * ambiguity;
    if (candidate_m < near || candidate_m > far || !SurfaceEvidence::representable(k - relative)) continue;
    ++evidence.ground[SurfaceEvidence::bin(k - relative)];
    if (anchors) {
      ++evidence.anchor[SurfaceEvidence::bin(k - relative)];
      evidence.anchor_plane.add(body_point(tables, body_rotation_, i, candidate_m));
    }
    vote_[i] = static_cast<std::int8_t>(k);
    return;
  }
}

void PhaseEvidence::vote_by_map(const RayTables& tables, const RowPoses& poses, const GroundLookup& ground, int row,
                                std::size_t i, float range_m, int relative, SurfaceEvidence& evidence) {
  const FilterConfig& filter = tables.sensor->filter;
  const float ambiguity = static_cast<float>(tables.projection->ambiguity_m);
  int matches = 0;
  int match = 0;
  for (int k = kFirstCandidate; k <= filter.max_wraps; ++k) {
    const float candidate_m = range_m + static_cast<float>(k) * ambiguity;
    if (candidate_m <= 0.0F || !SurfaceEvidence::representable(k - relative)) continue;
    const MapPoint point = map_point(tables, poses, row, i, candidate_m);
    const auto known = ground(point.position_m.x(), point.position_m.y());
    if (!known) continue;
    ++evidence.covered[SurfaceEvidence::bin(k - relative)];
    const double sigma_m = std::sqrt(point.height_variance_m2 + known->sigma_m * known->sigma_m);
    if (std::abs(point.position_m.z() - known->z_m) > filter.map_gate_sigmas * sigma_m + filter.map_gate_m) continue;
    ++matches;
    match = k;
  }
  if (matches != 1) return;
  ++evidence.mapped[SurfaceEvidence::bin(match - relative)];
  if (vote_[i] == kNoVote) vote_[i] = static_cast<std::int8_t>(match);
}

}  // namespace scree
