#pragma once
// What every reconstruction is given and what it gives back.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "core/grid.hpp"
#include "fractal/surface.hpp"

namespace scree::fractal {

/// Heights known at points, four spans of one length. Metres from the outer corner of cell (0, 0) of the grid to be
/// made: x along its columns, y along its rows, so the centre of cell (r, c) is ((c + ½)·cell, (r + ½)·cell).
struct HeightSamples {
  std::vector<double> x_m, y_m, z_m;
  std::vector<double>
      variance_m2;  ///< of the measurement alone, ≥ 0; what lies between point and centre is added later
  std::size_t size() const { return z_m.size(); }
};

struct SurfaceGrid {
  int rows = 0, columns = 0;
  double cell_m = 0.1;
};

/// D and amplitude of the ground: one law, or one for each cell.
struct LawMap {
  FractalLaw law;           ///< the one law; of a varying map its middle, for what needs a single number
  Grid<float> dimension;    ///< empty: `law` everywhere; else the shape of the grid, every value in (2, 3)
  Grid<float> amplitude_m;  ///< empty exactly when `dimension` is; > 0

  bool varies() const { return !dimension.empty(); }
  FractalLaw at(int row, int column) const {
    if (!varies()) return law;
    return {static_cast<double>(dimension(row, column)), static_cast<double>(amplitude_m(row, column))};
  }
};

struct SurfaceRequest {
  SurfaceGrid grid;
  LawMap law;
  int draws = 1;
  std::uint64_t seed = 1;
  /// Called with each draw k = 0 … draws − 1 in turn; the grid is the method's buffer and lives for the call only.
  std::function<void(int k, const Grid<float>& draw_m)> on_draw;
  /// Called now and then with the share of the work that is done, 0 … 1.
  std::function<void(double share)> on_progress;
};

/// Where a method has no answer for a cell (outside a triangulation) it is NaN.
struct SurfaceEstimate {
  Grid<float> mean_m;
  Grid<float> sd_m;    ///< what the method itself says of its error; all NaN for a method without one
  int iterations = 0;  ///< of the method's own kind: cycles, sweeps, insertions
  bool converged = true;
  Grid<std::uint8_t> rejected = {};  ///< 1 = a datum that the method took for no ground and left out; empty if none
  std::size_t rejected_cells = 0;    ///< how many
  bool law_contradicted = false;     ///< so many data are no ground of the law that none was left out
};

}  // namespace scree::fractal
