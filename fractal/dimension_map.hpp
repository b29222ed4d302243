#pragma once
// D for every cell of a grid, from second-difference energies in box windows.

#include <cstdint>
#include <memory>

#include "core/executor.hpp"
#include "core/grid.hpp"

namespace scree::fractal {

enum DimensionFlag : std::uint8_t {
  kTooLittleData = 1,  ///< too few complete increments in the window: D is NaN
  kNoiseLimited = 2,   ///< the known noise explains most of the roughness: D is an upper bound at best
  kNotFractal = 4,     ///< the energies contradict every single power law
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

/// Holds the gain tables and the work buffers; one per thread of use.
class DimensionMapper {
 public:
  explicit DimensionMapper(const DimensionMapConfig& config);
  ~DimensionMapper();
  DimensionMapper(DimensionMapper&&) noexcept;
  DimensionMapper& operator=(DimensionMapper&&) noexcept;

  /// height_m: NaN = unknown. variance_m2: known noise variance of each height. hits: number of returns averaged in
  /// the cell (its support: mean of that many points at random places in the cell).
  void update(const Grid<float>& height_m, const Grid<float>& variance_m2, const Grid<std::uint16_t>& hits,
              Executor& executor, DimensionMap& out);

 private:
  struct Tables;
  std::unique_ptr<Tables> tables_;
};

}  // namespace scree::fractal
