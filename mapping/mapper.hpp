#pragma once
// The map: frames in, snapshots out, no thread of its own.

#include <cstdint>
#include <memory>

#include "core/executor.hpp"
#include "core/result.hpp"
#include "drivers/frame/point_frame.hpp"
#include "drivers/frame/range_frame.hpp"
#include "mapping/alignment_report.hpp"
#include "mapping/cost.hpp"
#include "mapping/snapshot.hpp"
#include "mapping/stages.hpp"
#include "mapping/vehicle.hpp"

namespace scree::mapping {

struct MapConfig {
  double cell_m = 0.1;
  int size_cells = 200;                  ///< side of the square rolling window
  int dimension_radius_cells = 10;       ///< of the large window of D
  int dimension_small_radius_cells = 5;  ///< of the small one
  double dimension_sigma_target = 0.1;   ///< the small window's D is reported where it is at least this certain
  double reconstruct_reach_m = 0.6;      ///< unmeasured cells farther than this from measured ones stay unknown
  double drop_margin_m = 0.2;            ///< possible_drop: rays passed this much below the expected ground
  double outlier_sigmas = 5.0;
  int draws = 8;             ///< K ≥ 2 posterior draws behind standard deviation and risk
  int headings = 8;          ///< sectors of half a turn that the risk is told for
  bool align_frames = true;  ///< lay every frame onto the map, and the map after the pose
  /// Of poses whose source tells no variance ("pose.sigma_*").
  double pose_sigma_xy_m = 0.0;
  double pose_sigma_z_m = 0.0;
  double pose_sigma_attitude_rad = 0.0;
  std::uint64_t seed = 1;
  CostConfig cost;
  VehicleConfig vehicle;
};

/// Every point is counted once: counts.points == points_fused + points_outside + points_outlier + points_other_surface.
struct StepReport {
  PixelCounts counts;
  std::uint64_t points_fused = 0;
  std::uint64_t points_outside = 0;        ///< outside the window, or not finite
  std::uint64_t points_outlier = 0;        ///< contradicted the stored height, the ground around, or the whole map
  std::uint64_t points_unsupported = 0;    ///< among points_outlier: alone above or below the ground around
  std::uint64_t points_other_surface = 0;  ///< canopy, overhang, or the other side of an edge inside a cell
  StageTimes stages;                       ///< the one thing here that differs from run to run
  AlignmentReport alignment;
};

class Mapper {
 public:
  /// `executor` must outlive the mapper. `config` must be valid (config/ checks it): cell_m, size_cells,
  /// dimension radii, headings > 0, draws ≥ 2, the rest ≥ 0.
  Mapper(const MapConfig& config, Executor& executor);
  ~Mapper();
  Mapper(const Mapper&) = delete;
  Mapper& operator=(const Mapper&) = delete;

  /// Rolls the window to the frame's body position, converts, fuses and computes every layer. Deterministic: the same
  /// frames give the same bytes for any executor, however often snapshot() is called. Fails (bad_data) on a frame that
  /// contradicts its projection and on a pose beyond the lattice; the map is then unchanged.
  Result<StepReport> step(const RangeFrame& frame);

  /// The part of step() after the conversion, for points that are Cartesian already.
  Result<StepReport> integrate(const PointFrame& points);

  /// The map after the last step; immutable, from a pool of reused buffers. Null before the first step.
  std::shared_ptr<const MapSnapshot> snapshot();

 private:
  Result<StepReport> integrate(const PointFrame& points, StageClock& clock);

  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace scree::mapping
