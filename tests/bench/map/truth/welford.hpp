#pragma once
// The plainest map there is: mean and variance of all returns of a cell [W62]. The floor for speed and the ground that
// the baselines stand on.

#include "core/grid.hpp"
#include "drivers/frame/point_frame.hpp"

namespace scree::bench {

/// Row 0 at the smallest y. mean_m is NaN where no return fell.
struct WelfordMap {
  LatticeWindow window;
  Grid<float> mean_m;
  Grid<std::uint32_t> hits;
};

/// Everything that falls onto a square of the lattice about the map's origin; nothing rolls, nothing is rejected.
class WelfordFusion {
 public:
  /// Holds (2·size_cells)² cells about the map's origin.
  WelfordFusion(double cell_m, int size_cells);

  /// Converts as the mapper does, with the heights that this map knows for the phase resolver, then add().
  void add(const RangeFrame& frame);
  void add(const PointFrame& points);
  WelfordMap cut(const LatticeWindow& window) const;

 private:
  struct Cell {
    std::uint32_t hits = 0;
    float mean_m = 0.0F, square_m2 = 0.0F;  ///< mean, and the sum of squares about it
  };
  double cell_m_;
  LatticeWindow window_;
  Grid<Cell> cells_;
  PointConverter converter_;
  PointFrame points_;
};

}  // namespace scree::bench
