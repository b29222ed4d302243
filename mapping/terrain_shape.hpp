#pragma once
// Slope at the scale of the vehicle's footprint, step at the scale of a wheel.

#include <span>

#include "core/executor.hpp"
#include "core/grid.hpp"

namespace scree::mapping {

struct ShapeConfig {
  double cell_m = 0.1;
  int slope_radius_cells = 3;   ///< the plane is fitted to the known cells of (2·radius+1)²
  double step_radius_m = 0.15;  ///< of the disc; at least one cell is looked at
};

/// Row-parallel; keeps its buffers.
class TerrainShape {
 public:
  explicit TerrainShape(const ShapeConfig& config) : config_(config) {}

  /// slope_rad alone, as update() gives it.
  void slopes(const Grid<float>& elevation_m, Executor& executor, Grid<float>& slope_rad);

  /// elevation_m: NaN = unknown; variance_m2: noise of each height (0 where reconstructed); relief_m2: variance of
  /// the returns inside a cell. Results are NaN where the elevation is.
  /// slope_rad: of the least-squares plane through the window's known heights; NaN too where fewer than 5 are known or
  /// they lie on a line. Exact on planes.
  /// step_m: largest height difference between the cell and a known cell of the disc, d² less 4 times the noise
  /// variance of d, so that it is zero on noise and exact on edges far above it; or the relief inside the cell,
  /// √(12 · relief) (the height of an evenly sampled face), if that is more. Cost: O(cells · (radius² + disc)),
  /// vectorised.
  void update(const Grid<float>& elevation_m, const Grid<float>& variance_m2, const Grid<float>& relief_m2,
              Executor& executor, Grid<float>& slope_rad, Grid<float>& step_m);

 private:
  int step_reach_cells() const;
  void pad(const Grid<float>& elevation_m, Executor& executor);
  void steps(const Grid<float>& elevation_m, const Grid<float>& variance_m2, const Grid<float>& relief_m2,
             Executor& executor, Grid<float>& step_m);
  void step_row(const Grid<float>& relief_m2, int row, std::span<float> best) const;
  void sum_rows(int row, int columns);
  void fit_row(const Grid<float>& elevation_m, int row, Grid<float>& slope_rad);

  ShapeConfig config_;
  int margin_ = 0;
  Grid<float> z_, variance_, known_;    ///< with a margin of unknown cells
  Grid<float> n_, nx_, nxx_, z0_, zx_;  ///< moments of a row of 2·radius+1 cells
};

}  // namespace scree::mapping
