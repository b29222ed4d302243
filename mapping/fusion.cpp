#include "mapping/fusion.hpp"

#include <algorithm>

#include "core/executor.hpp"

namespace scree::mapping {

namespace {

constexpr float kPooledHits = 200.0F;  // the relief forgets beyond this many returns

void replace(const GroundReturn& frame, MapCell& cell) {
  cell.height_m = frame.height_m;
  cell.noise_variance_m2 = frame.noise_variance_m2;
  cell.shared_variance_m2 = frame.shared_variance_m2;
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
  const float between_m2 =
      std::max(0.0F, innovation_m * innovation_m - cell.noise_variance_m2 - cell.shared_variance_m2 -
                         frame.noise_variance_m2 - frame.shared_variance_m2);
  cell.relief_m2 = (1.0F - share) * cell.relief_m2 + share * frame.relief_m2 + share * (1.0F - share) * between_m2;
  cell.height_m += gain * innovation_m;
  const auto mixed = [gain](float stored, float seen) {
    return (1.0F - gain) * (1.0F - gain) * stored + gain * gain * seen;
  };
  cell.noise_variance_m2 = mixed(cell.noise_variance_m2, frame.noise_variance_m2);
  cell.shared_variance_m2 = mixed(cell.shared_variance_m2, frame.shared_variance_m2);
  cell.hits = static_cast<std::uint16_t>(std::min(int{cell.hits} + frame.hits, 65535));
  cell.contradictions = 0;
}

}  // namespace

FusionCounts fuse_cell(const GroundReturn& frame, const GroundConfig& config, MapCell& cell) {
  const auto hits = static_cast<std::uint64_t>(frame.hits);
  FusionCounts counts;
  counts.other_surface = static_cast<std::uint64_t>(frame.others);
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
  const float stored_m2 = height_variance_m2(cell, config.cell_m);
  const float frame_m2 = height_variance_m2(frame.noise_variance_m2 + frame.shared_variance_m2, frame.relief_m2,
                                            frame.hits, config.cell_m);
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

FusionCounts Fusion::fuse(CellPoints& points, double anchor_z_m, Executor& executor, RollingGrid<MapCell>& map) {
  row_counts_.assign(static_cast<std::size_t>(points.rows()), {});
  for_rows(executor, points.rows(), [&](int begin, int end) {
    for (int row = begin; row < end; ++row) {
      FusionCounts& counts = row_counts_[static_cast<std::size_t>(row)];
      for (int column = 0; column < points.columns(); ++column) {
        if (points.count(row, column) == 0) continue;
        MapCell& cell = map(row, column);
        StoredHeight stored;
        if (cell.measured())
          stored = {static_cast<float>(static_cast<double>(cell.height_m) - anchor_z_m),
                    height_variance_m2(cell, config_.cell_m)};
        GroundReturn frame =
            ground_return(points.heights_m(row, column), points.variances_m2(row, column), stored, config_);
        frame.height_m = static_cast<float>(static_cast<double>(frame.height_m) + anchor_z_m);
        frame.bottom_m = static_cast<float>(static_cast<double>(frame.bottom_m) + anchor_z_m);
        const FusionCounts cell_counts = fuse_cell(frame, config_, cell);
        counts.fused += cell_counts.fused;
        counts.outlier += cell_counts.outlier;
        counts.other_surface += cell_counts.other_surface;
      }
    }
  });
  FusionCounts total;
  for (const FusionCounts& row : row_counts_) {
    total.fused += row.fused;
    total.outlier += row.outlier;
    total.other_surface += row.other_surface;
  }
  return total;
}

}  // namespace scree::mapping
