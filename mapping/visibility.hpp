#pragma once
// Which cells a frame's rays crossed, how low, and which lie in a shadow.

#include <vector>

#include "core/executor.hpp"
#include "core/rolling_grid.hpp"
#include "drivers/frame/point_frame.hpp"
#include "mapping/alignment_report.hpp"
#include "mapping/cell_points.hpp"
#include "mapping/fusion.hpp"
#include "mapping/map_cell.hpp"
#include "mapping/polar_rays.hpp"

namespace scree::mapping {

struct VisibilityConfig {
  double cell_m = 0.1;
  int size_cells = 200;
  float max_descent = 0.5F;  ///< rise over run, see PolarConfig
  /// A stored height is seen through by rays that pass this much (and 5 sigma and 2 reliefs) below it.
  float margin_m = 0.2F;
};

/// Keeps, per cell of the map, the ceiling that rays have set, the ground expected there, and shadows; forgets heights
/// that the rays of kFramesToForget frames see through: what stood there has moved. A frame whose sensor moves by more
/// than a cell is taken in pieces of rows, each with
/// its own origin. Cost: O(points + pieces · cells).
class Visibility {
 public:
  explicit Visibility(const VisibilityConfig& config);
  /// Before the fusion of the same frame: `points` tells which cells it hit. `off` is what alignment took off its
  /// heights.
  void update(const PointFrame& frame, const CellPoints& points, const HeightPlane& off, Executor& executor,
              RollingGrid<MapCell>& map);

 private:
  void look_from(const PointFrame& frame, std::size_t row_begin, std::size_t row_end, Executor& executor);
  void mark(const Eigen::Vector3d& origin_map_m, const CellPoints& points, const HeightPlane& off, Executor& executor,
            RollingGrid<MapCell>& map);

  VisibilityConfig config_;
  PolarRays rays_;
  std::vector<float> x_m_, y_m_, z_m_;
  std::vector<std::uint8_t> passed_;  ///< per cell of the window: seen through in this frame
};

}  // namespace scree::mapping
