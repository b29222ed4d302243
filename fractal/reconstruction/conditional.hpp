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
  int max_cells = 512;  ///< largest side of a window; the random fields repeat every 1.5 × this
  std::uint64_t seed = 1;
  double tolerance = 0.05;  ///< stop when r·z < tolerance² · cells (0.02 is used below D = 2.3)
  int max_iterations = 60;
};

struct Reconstruction {
  Grid<float> mean_m;  ///< posterior mean, every cell
  Grid<float> draw_m;  ///< one posterior draw: as rough as the law says, equal to the data within their noise
  int iterations = 0;  ///< multigrid cycles, mean and draw together
  bool converged = true;
};

/// Mean: A·x = c·d, A = w1·L + w2·L² + diag(c), c = 1/variance, in units of the rms change over one cell. Draw: mean +
/// u − A⁻¹(c·u + √c·n) with u an unconditional fBm and n white noise, both anchored to the world: the noise of a
/// lattice cell never changes, so draws of successive frames agree where the data do. u − A⁻¹(c·u + √c·n) has the law
/// of the mean's true error whatever A is, so the draw is calibrated although the blend only resembles the fractal
/// prior. Source: Matheron's rule [CD12] ch. 7; prior [Sz89]; docs/fractal.md. Keeps tiles, levels and the last
/// solution (warm start): the result depends on earlier calls within the tolerance, and on nothing else than the
/// inputs. The tiles of a new D (steps of 0.1) cost some tens of ms once.
class ConditionalReconstructor {
 public:
  explicit ConditionalReconstructor(const ReconstructionConfig& config);
  ~ConditionalReconstructor();
  ConditionalReconstructor(ConditionalReconstructor&&) noexcept;
  ConditionalReconstructor& operator=(ConditionalReconstructor&&) noexcept;

  /// height_m: NaN = unmeasured. variance_m2 > 0 where measured (values below 1e-6 of the squared change over one cell
  /// count as that). `window` places the grids on the world lattice; rows, columns ≤ max_cells. One law for the whole
  /// window, D clamped to [2.05, 2.95], amplitude > 0. With no measured cell the output is NaN and not converged.
  /// Cost: tests/bench/reconstruction_bench.cpp. Uses at most two threads of the executor.
  void reconstruct(const Grid<float>& height_m, const Grid<float>& variance_m2, const LatticeWindow& window,
                   const FractalLaw& law, Executor& executor, Reconstruction& out);

 private:
  struct Solver;
  std::unique_ptr<Solver> solver_;
};

}  // namespace scree::fractal
