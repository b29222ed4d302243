#pragma once
// The map: frames in, snapshots out, no thread of its own.

#include <functional>
#include <memory>

#include "core/executor.hpp"
#include "core/result.hpp"
#include "drivers/frame/point_frame.hpp"
#include "drivers/frame/range_frame.hpp"
#include "mapping/snapshot.hpp"
#include "mapping/vehicle.hpp"

namespace scree::mapping {

struct MapConfig {
  double cell_m = 0.1;
  int size_cells = 200;  ///< side of the square rolling window
  int dimension_radius_cells = 10;
  double reconstruct_reach_m = 0.6;  ///< unmeasured cells farther than this from measured ones stay unknown
  double drop_margin_m = 0.2;        ///< possible_drop: rays passed this much below the expected ground
  double outlier_sigmas = 5.0;
  std::uint64_t seed = 1;
  VehicleConfig vehicle;
};

struct StepReport {
  PixelCounts counts;
  std::uint64_t points_fused = 0;
  std::uint64_t points_outside = 0;  ///< outside the window
  std::uint64_t points_outlier = 0;  ///< gated out
};

class Mapper {
 public:
  Mapper(const MapConfig& config, Executor& executor);
  ~Mapper();

  /// Converts, fuses, updates every layer, rolls the window to the frame's body position. Deterministic: the same
  /// frames give the same bytes for any executor.
  Result<StepReport> step(const RangeFrame& frame);

  /// The map after the last step; immutable, from a pool of reused buffers. Null before the first step.
  std::shared_ptr<const MapSnapshot> snapshot();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace scree::mapping
