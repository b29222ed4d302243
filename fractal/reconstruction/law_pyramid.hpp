#pragma once
// A law that varies over the map, seen more and more coarsely.

#include <vector>

#include "core/grid.hpp"
#include "fractal/reconstruction/surface_problem.hpp"

namespace scree::fractal {

/// H and the logarithm of the rms change over a cell (over `unit_m`), averaged over blocks of 2^g cells whose edges are
/// multiples of 2^g on the world lattice, so that a window that moves sees the same blocks. Amplitudes are averaged as
/// logarithms: a mean of squares would carry the long waves of rough ground far into its smooth neighbours.
class LawPyramid {
 public:
  struct Level {
    Grid<float> log_sigma, hurst;
  };

  /// `law` varies; its grids lie at `window`. Levels 0 … `levels` − 1. The window is grown to whole blocks of the
  /// coarsest level, with copies of its border. D is clamped to [2.05, 2.95]. No allocation when the shape is
  /// unchanged.
  void build(const LawMap& law, const LatticeWindow& window, double unit_m, double cell_m, int levels);

  const Level& level(int g) const { return levels_[static_cast<std::size_t>(g)]; }
  /// The lattice cell of block (0, 0), of every level.
  CellIndex start() const { return start_; }

 private:
  void load_row(const LawMap& law, const LatticeWindow& window, double unit_m, double cell_m, int row);

  CellIndex start_;
  std::vector<Level> levels_;
};

/// In place, along both axes: Gaussian smoothing of a variance of 2 cells² (nine binomial weights), or of `variance` ≤
/// 1 by three; what lies outside repeats the border. `scratch` grows to the shape.
void smooth_two(Grid<float>& grid, Grid<float>& scratch);
void smooth_little(Grid<float>& grid, float variance, Grid<float>& scratch);

}  // namespace scree::fractal
