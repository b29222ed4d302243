#pragma once
// D for every cell of a grid, from second-difference energies in box windows.

#include <cstdint>

#include "core/executor.hpp"
#include "core/grid.hpp"
#include "fractal/energy_planes.hpp"

namespace scree::fractal {

enum DimensionFlag : std::uint8_t {
  /// Fewer complete axis increments than min_effective_cells, or increments of fewer than four of the eight classes, or
  /// of none over more than a cell: D is NaN.
  kTooLittleData = 1,
  /// The known noise variance exceeds the squared height change over one cell (τ > 1): D is an upper bound at best.
  kNoiseLimited = 2,
  /// The energies contradict every single power law: residual chi-square above its 99.9 % point (6 degrees of freedom;
  /// fewer where classes are missing).
  kNotFractal = 4,
  /// Second differences of one direction are larger than those across: the chi-square of four contrasts (axes and
  /// diagonals at steps of 1 and 2 cells) is above its 99.9 % point. D is then a mean over directions, and the
  /// amplitude too. Not judged where classes are missing.
  kAnisotropic = 8,
  /// D stands at the smallest value that the data can tell (2.02; 2.21 for cells of one return, whose random places
  /// look
  /// like noise): the ground is that smooth or smoother, and dimension_sigma does not bound D from below. An exact
  /// plane
  /// has D = 2.02, amplitude 0, sigma NaN.
  kAtBound = 16,
};

struct DimensionMapConfig {
  double cell_m = 0.1;
  int radius_cells = 10;  ///< window of (2·radius+1)² cells
  int min_effective_cells = 8;
};

/// Layers of the input's shape; NaN where flagged kTooLittleData.
struct DimensionMap {
  Grid<float> dimension;
  Grid<float> dimension_sigma;  ///< one standard deviation
  Grid<float> amplitude_m;      ///< rms height change at 1 m
  Grid<std::uint8_t> flags;
};

/// Second differences of eight shapes, their mean squares over a window, and generalised least squares on the
/// logarithms (docs/fractal.md). Adding any plane to the heights changes nothing but rounding. 2.02 ≤ D ≤ 2.98. Holds
/// the sums and the work buffers; one per thread of use. The gain tables are built once a process.
class DimensionMapper {
 public:
  explicit DimensionMapper(const DimensionMapConfig& config);

  /// Three grids of one shape. height_m: NaN = unknown. variance_m2: known noise variance of each height (of the mean,
  /// where it is a mean); a return displaced horizontally by δ on a slope g adds (g·δ)², so either move heights to the
  /// cell centre along the local plane or include slope²·cell²/(12·hits) here. hits: number of returns averaged in the
  /// cell (its support: mean of that many points at random places in the cell); all 0 = heights of the exact centres.
  /// Cost: tests/bench/dimension_bench.cpp; independent of the radius; no allocation after the first call of a shape.
  void update(const Grid<float>& height_m, const Grid<float>& variance_m2, const Grid<std::uint16_t>& hits,
              Executor& executor, DimensionMap& out);

  /// The same bytes as above for a map that is updated again and again, its window where it may be on the lattice: what
  /// has not changed since the last call, cell by cell of the lattice, is not computed again. A changed height costs
  /// its increments and the fits of the windows that hold one of them, a changed variance or hit count the fits of its
  /// windows; changes are found by comparing. The sums over windows are made anew if anything changed. The result is
  /// valid until the next call.
  const DimensionMap& update(const LatticeWindow& window, const Grid<float>& height_m, const Grid<float>& variance_m2,
                             const Grid<std::uint16_t>& hits, Executor& executor);
  /// The same for the cells of `wanted` (1; the window's shape) alone: the others keep what they had, on the lattice,
  /// and are made up to date by the first call that wants them.
  const DimensionMap& update(const LatticeWindow& window, const Grid<float>& height_m, const Grid<float>& variance_m2,
                             const Grid<std::uint16_t>& hits, const Grid<std::uint8_t>& wanted, Executor& executor);

 private:
  void clear(int rows, int columns);
  void scroll_to(const LatticeWindow& window);
  void fit_row(const DimensionTables& tables, const Grid<std::uint8_t>* wanted, int row);
  void fit(const Grid<std::uint8_t>* wanted, Executor& executor);

  DimensionMapConfig config_;
  float log_cell_;
  EnergyPlanes planes_;
  LatticeWindow window_;  ///< of the last update; no rows: none
  DimensionMap map_;
  Grid<std::uint8_t> stale_;  ///< 1 = the window has changed since the cell was fitted
};

}  // namespace scree::fractal
