#pragma once
// D for every cell of a grid, from second-difference energies in box windows.

#include <cstdint>
#include <memory>

#include "core/executor.hpp"
#include "core/grid.hpp"

namespace scree::fractal {

enum DimensionFlag : std::uint8_t {
  /// Fewer complete axis increments than min_effective_cells, or a class of increments with none: D is NaN.
  kTooLittleData = 1,
  /// The known noise variance exceeds the squared height change over one cell (τ > 1), or D stands at the smallest
  /// value
  /// that the data can tell (2.02; 2.21 for cells of one return, whose random places look like noise): D is an
  /// upper bound at best. An exact plane has D = 2.02, amplitude 0, sigma NaN.
  kNoiseLimited = 2,
  /// The energies contradict every single power law: residual chi-square above its 99.9 % point (6 degrees of freedom).
  kNotFractal = 4,
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
/// the work buffers; one per thread of use. The gain tables are built once a process, at the first update.
class DimensionMapper {
 public:
  explicit DimensionMapper(const DimensionMapConfig& config);
  ~DimensionMapper();
  DimensionMapper(DimensionMapper&&) noexcept;
  DimensionMapper& operator=(DimensionMapper&&) noexcept;

  /// Three grids of one shape. height_m: NaN = unknown. variance_m2: known noise variance of each height (of the mean,
  /// where it is a mean); a return displaced horizontally by δ on a slope g adds (g·δ)², so either move heights to the
  /// cell centre along the local plane or include slope²·cell²/(12·hits) here. hits: number of returns averaged in the
  /// cell (its support: mean of that many points at random places in the cell); all 0 = heights of the exact centres.
  /// Cost: tests/bench/dimension_bench.cpp; independent of the radius; no allocation after the first call of a shape.
  void update(const Grid<float>& height_m, const Grid<float>& variance_m2, const Grid<std::uint16_t>& hits,
              Executor& executor, DimensionMap& out);

 private:
  struct Tables;
  std::unique_ptr<Tables> tables_;
};

}  // namespace scree::fractal
