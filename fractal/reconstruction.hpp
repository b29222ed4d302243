#pragma once
// Dense rough ground from sparse heights: Matheron's rule with the 13-point blend prior.

#include <cstdint>
#include <memory>

#include "core/executor.hpp"
#include "core/grid.hpp"
#include "fractal/surface.hpp"

namespace scree::fractal {

struct ReconstructionConfig {
  double cell_m = 0.1;
  int max_cells = 512;  ///< largest side of a window
  std::uint64_t seed = 1;
  double tolerance = 0.05;  ///< stop when r·z < tolerance² · cells (0.02 is used below D = 2.3)
  int max_iterations = 60;
};

struct Reconstruction {
  Grid<float> mean_m;  ///< posterior mean, every cell
  Grid<float> draw_m;  ///< one posterior draw: as rough as the law says, equal to the data within their noise
  int iterations = 0;
  bool converged = true;
};

/// Keeps tiles, levels and the last solution (warm start). World-anchored: the noise of a lattice cell never changes.
class ConditionalReconstructor {
 public:
  explicit ConditionalReconstructor(const ReconstructionConfig& config);
  ~ConditionalReconstructor();
  ConditionalReconstructor(ConditionalReconstructor&&) noexcept;
  ConditionalReconstructor& operator=(ConditionalReconstructor&&) noexcept;

  /// height_m: NaN = unmeasured. variance_m2 > 0 where measured. `window` places the grids on the world lattice.
  /// At least one cell must be measured. One law for the whole window.
  void reconstruct(const Grid<float>& height_m, const Grid<float>& variance_m2, const LatticeWindow& window,
                   const FractalLaw& law, Executor& executor, Reconstruction& out);

 private:
  struct Solver;
  std::unique_ptr<Solver> solver_;
};

}  // namespace scree::fractal
