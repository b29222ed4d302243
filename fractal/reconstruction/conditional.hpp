#pragma once
// Dense rough ground from sparse heights, frame after frame: Matheron's rule with the 13-point blend prior.

#include <cstdint>
#include <memory>
#include <vector>

#include "core/executor.hpp"
#include "core/grid.hpp"
#include "fractal/reconstruction/surface_problem.hpp"
#include "fractal/surface.hpp"

namespace scree::fractal {

struct ReconstructionConfig {
  double cell_m = 0.1;
  int max_cells = 512;  ///< largest side of a window; the random fields repeat every 1.5 × this (2 × of varying laws)
  std::uint64_t seed = 1;
  double tolerance =
      0.05;  ///< stop when r·z < tolerance² · cells (at most 0.02 below D = 2.3; cold fields: conditioning.hpp)
  int max_iterations = 60;
  int residual_fields = 1;          ///< K ≥ 1, kept from frame to frame: one draw is made from each
  bool standard_deviation = false;  ///< make Reconstruction::sd_m, too
};

struct Reconstruction {
  Grid<float> free_mean_m;  ///< the mean by the heights alone, without the ceilings; empty when none pushed
  Grid<float> mean_m;       ///< posterior mean, every cell
  std::vector<Grid<float>>
      draws_m;  ///< K posterior draws: as rough as the law says, equal to the data within their noise
  /// Mean square of the K residual fields, K degrees of freedom: what SdMap makes a standard deviation from. Empty for
  /// K = 1.
  Grid<float> mean_square_m2;
  Grid<float> sd_m;  ///< standard deviation of the mean's error (SdMap, ceilings allowed for); empty when not asked for
  int iterations = 0;  ///< multigrid cycles, mean and fields together
  bool converged = true;
};

/// Mean: A·x = c·d, A the operator of multigrid.hpp, c = 1/variance, in units of the rms change over one cell. Residual
/// k: r_k = u_k − A⁻¹(c·u_k + √c·n_k) with u_k an unconditional fBm and n_k white noise, both anchored to the world:
/// the noise of a lattice cell never changes, so draws of successive frames agree where the data do. r_k has the law of
/// the mean's true error whatever A is, so the draw, mean + r_0, is calibrated although the blend only resembles the
/// fractal prior. Source: Matheron's rule [CD12] ch. 7; prior [Sz89]; docs/reconstruction.md. Keeps tiles, levels and
/// the last solutions (warm start: the mean itself, u_new − r_old of each field): the result depends on earlier calls
/// within the tolerance, and on nothing else than the inputs. The tiles of a new D (steps of 0.1) cost some tens of ms
/// once, the bands of varying laws some hundred.
class ConditionalReconstructor {
 public:
  explicit ConditionalReconstructor(const ReconstructionConfig& config);
  ~ConditionalReconstructor();
  ConditionalReconstructor(ConditionalReconstructor&&) noexcept;
  ConditionalReconstructor& operator=(ConditionalReconstructor&&) noexcept;

  /// height_m: NaN = unmeasured. variance_m2 > 0 where measured (values below 1e-6 of the squared change over one cell
  /// count as that). `window` places the grids on the world lattice; rows, columns ≤ max_cells. One law for the whole
  /// window, or one a cell in grids of the window's shape without NaN; D clamped to [2.05, 2.95], amplitudes > 0. With
  /// no measured cell the output is NaN and not converged. Cost: docs/reconstruction.md. Uses at most K + 1 threads of
  /// the executor and does not depend on them.
  void reconstruct(const Grid<float>& height_m, const Grid<float>& variance_m2, const LatticeWindow& window,
                   const LawMap& law, Executor& executor, Reconstruction& out);
  void reconstruct(const Grid<float>& height_m, const Grid<float>& variance_m2, const LatticeWindow& window,
                   const FractalLaw& law, Executor& executor, Reconstruction& out);
  /// The same below `ceiling_m`: the height of the lowest ray over each cell, NaN or +inf = none (at measured cells it
  /// is not looked at). Every draw is pushed below (ceiling_push.hpp) in one round a frame that starts from the last
  /// frame's push, so a new ceiling takes some frames to be fully heard; the mean moves by the mean push.
  void reconstruct(const Grid<float>& height_m, const Grid<float>& variance_m2, const Grid<float>& ceiling_m,
                   const LatticeWindow& window, const LawMap& law, Executor& executor, Reconstruction& out);

 private:
  struct Solver;
  std::unique_ptr<Solver> solver_;
};

}  // namespace scree::fractal
