#include "mapping/fusion.hpp"

#include <algorithm>

#include "core/executor.hpp"

namespace scree::mapping {

namespace {

constexpr float kPooledHits = 200.0F;  // the relief forgets beyond this many returns
constexpr float kInsist_s = 3.0F;      // a few frames of the slowest scanners

void replace(const GroundReturn& frame, MapCell& cell) {
  cell.height_m = frame.height_m;
  cell.noise_variance_m2 = frame.noise_variance_m2;
  cell.shared_variance_m2 = frame.shared_variance_m2;
  cell.place_variance_m2 = frame.place_variance_m2;
  cell.relief_m2 = frame.relief_m2;
  cell.hits = static_cast<std::uint16_t>(std::min(frame.hits, 65535));
  cell.contradictions = 0;
}

void average(const GroundReturn& frame, float stored_m2, float frame_m2, MapCell& cell) {
  const float gain = stored_m2 / (stored_m2 + frame_m2);
  const float innovation_m = frame.height_m - cell.height_m;
  const float n_old = std::min(static_cast<float>(cell.hits), kPooledHits);
  const float n_new = static_cast<float>(frame.hits);
  const float share = n_new / (n_old + n_new);
  const float pose_m2 =
      frame.against_map_m2 >= 0.0F ? frame.against_map_m2 : cell.shared_variance_m2 + frame.shared_variance_m2;
  const float explained_m2 =
      cell.noise_variance_m2 + cell.place_variance_m2 + frame.noise_variance_m2 + frame.place_variance_m2 + pose_m2;
  const float between_m2 = std::max(0.0F, innovation_m * innovation_m - explained_m2);
  cell.relief_m2 = (1.0F - share) * cell.relief_m2 + share * frame.relief_m2 + share * (1.0F - share) * between_m2;
  cell.height_m += gain * innovation_m;
  const auto mixed = [gain](float stored, float seen) {
    return (1.0F - gain) * (1.0F - gain) * stored + gain * gain * seen;
  };
  cell.noise_variance_m2 = mixed(cell.noise_variance_m2, frame.noise_variance_m2);
  // The pose errs slowly: what the frames share with each other does not average away.
  cell.shared_variance_m2 += gain * (frame.shared_variance_m2 - cell.shared_variance_m2);
  cell.place_variance_m2 += gain * (frame.place_variance_m2 - cell.place_variance_m2);
  cell.hits = static_cast<std::uint16_t>(std::min(int{cell.hits} + frame.hits, 65535));
  cell.contradictions = 0;
}

/// A cell that holds nothing takes what the ground around refuses once kFramesToReplace frames have said so, none of
/// them long after the last: mixed pixels minutes apart are no surface.
bool insists(std::uint32_t now_ms, MapCell& cell) {
  if (age_s(now_ms, cell.fused_ms) > kInsist_s) cell.contradictions = 0;
  cell.fused_ms = now_ms;
  return ++cell.contradictions >= kFramesToReplace;
}

}  // namespace

FusionCounts fuse_cell(const GroundReturn& frame, const GroundConfig& config, MapCell& cell) {
  const auto hits = static_cast<std::uint64_t>(frame.hits);
  FusionCounts counts;
  counts.other_surface = static_cast<std::uint64_t>(frame.others);
  if (frame.bottom_m - cell.ceiling_m >= config.overhang_m) {  // rays passed below: a crown, a bridge
    const bool stored_too = cell.measured() && cell.height_m - cell.ceiling_m >= config.overhang_m;
    if (stored_too && ++cell.seen_through >= kFramesToForget) cell.forget_height();
    counts.other_surface += hits;
    return counts;
  }
  cell.seen_through = 0;
  if (!cell.measured()) {
    replace(frame, cell);
    counts.fused = hits;
    return counts;
  }
  if (frame.bottom_m - cell.height_m >= config.overhang_m) {
    counts.other_surface += hits;
    return counts;
  }
  // An aligned frame has its pose's errors in common with the map.
  const bool aligned = frame.against_map_m2 >= 0.0F;
  const float stored_m2 = own_variance_m2(cell, config.cell_m) + (aligned ? 0.0F : cell.shared_variance_m2);
  const float frame_m2 =
      own_variance_m2(frame, config.cell_m) + (aligned ? frame.against_map_m2 : frame.shared_variance_m2);
  const float innovation_m = frame.height_m - cell.height_m;
  const float gate = config.outlier_sigmas;
  if (innovation_m * innovation_m <= gate * gate * (stored_m2 + frame_m2)) {
    average(frame, stored_m2, frame_m2, cell);
    counts.fused = hits;
  } else if (++cell.contradictions >= kFramesToReplace || frame.hits >= kReturnsToReplace * cell.hits) {
    replace(frame, cell);
    counts.fused = hits;
  } else {
    counts.outlier = hits;
  }
  return counts;
}

FusionCounts Fusion::fuse_row(FrameReturns& frame, int row, std::uint32_t now_ms, RollingGrid<MapCell>& map) const {
  FusionCounts counts;
  for (const CellReturn& seen : frame.of_row(row)) {
    MapCell& cell = map(seen.row, seen.column);
    const auto hits = static_cast<std::uint64_t>(seen.ground.hits);
    if (!cell.measured() && gate_.refused(seen.row, seen.column) && !insists(now_ms, cell)) {
      counts.outlier += hits;
      counts.unsupported += hits;
      counts.other_surface += static_cast<std::uint64_t>(seen.ground.others);
      continue;
    }
    const FusionCounts of_cell = fuse_cell(seen.ground, config_, cell);
    if (of_cell.fused > 0) cell.fused_ms = now_ms;
    counts.fused += of_cell.fused;
    counts.outlier += of_cell.outlier;
    counts.other_surface += of_cell.other_surface;
  }
  return counts;
}

FusionCounts Fusion::fuse(FrameReturns& frame, std::uint32_t now_ms, const GateLaw& law, Executor& executor,
                          RollingGrid<MapCell>& map) {
  gate_.judge(frame, map, config_.cell_m, law, executor);
  row_counts_.assign(static_cast<std::size_t>(map.window().rows), {});
  for_rows(executor, map.window().rows, [&](int begin, int end) {
    for (int row = begin; row < end; ++row)
      row_counts_[static_cast<std::size_t>(row)] = fuse_row(frame, row, now_ms, map);
  });
  FusionCounts total;
  for (const FusionCounts& row : row_counts_) {
    total.fused += row.fused;
    total.outlier += row.outlier;
    total.unsupported += row.unsupported;
    total.other_surface += row.other_surface;
  }
  return total;
}

FusionCounts Fusion::refuse(const FrameReturns& frame) {
  FusionCounts total;
  for (const CellReturn& seen : frame.all())
    total.outlier += static_cast<std::uint64_t>(seen.ground.hits + seen.ground.others);
  return total;
}

}  // namespace scree::mapping
