#pragma once
// D of every cell from two sizes of windows.

#include <algorithm>
#include <cstdint>

#include "core/executor.hpp"
#include "core/grid.hpp"
#include "fractal/dimension_map.hpp"

namespace scree::mapping {

struct RoughnessConfig {
  double cell_m = 0.1;
  int small_radius_cells = 5;
  int large_radius_cells = 10;
  double sigma_target = 0.1;  ///< of D: the small window is reported where it is at least this certain
};

/// Grids of the window's shape; D, sigma and amplitude NaN, flagged kTooLittleData, where neither window could tell.
struct RoughnessMap : fractal::DimensionMap {
  Grid<std::uint8_t> radius_cells;  ///< of the window reported; 0 = none
};

/// A small window says where roughness changes, a large one says it more certainly. Reported is the small one where its
/// sigma meets the target, else the large one where there is one, else whatever the small one says.
class Roughness {
 public:
  explicit Roughness(const RoughnessConfig& config);

  /// Heights (NaN = unknown), the noise variance of each, and their support, at `window` of the lattice: see
  /// fractal::DimensionMapper::update. `wanted`: 1 = cells whose roughness is asked for; the others have none. The
  /// small and the large windows are brought up to date in turns, one a call (the first call does both), the large ones
  /// where the small do not suffice: D is at most one frame old. The result is valid until the next call. Row-parallel,
  /// no allocation when the shape stays.
  const RoughnessMap& update(const LatticeWindow& window, const Grid<float>& height_m, const Grid<float>& variance_m2,
                             const Grid<std::uint16_t>& support, const Grid<std::uint8_t>& wanted, Executor& executor);

  const fractal::DimensionMap& small() const { return *small_map_; }
  const fractal::DimensionMap& large() const { return *large_map_; }

 private:
  bool small_is_certain(int row, int column) const;
  void ask_row(const Grid<std::uint8_t>& wanted, int row);
  void ask_large_row(int row);
  int of_block(int index, std::int32_t min) const { return std::max(0, index - static_cast<int>((min + index) & 1)); }
  void choose_row(const Grid<std::uint8_t>& wanted, int row);

  RoughnessConfig config_;
  fractal::DimensionMapper small_, large_;
  const fractal::DimensionMap *small_map_ = nullptr, *large_map_ = nullptr;
  unsigned turn_ = 0;
  LatticeWindow window_;
  Grid<std::uint8_t> asked_;        ///< cells that stand for their blocks
  Grid<std::uint8_t> asked_large_;  ///< those whose small window does not suffice
  RoughnessMap map_;
};

}  // namespace scree::mapping
