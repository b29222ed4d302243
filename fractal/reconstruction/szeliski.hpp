#pragma once
// Szeliski's fractal prior in a relative multiresolution pyramid, with the temperature of Arakawa and Krotkov.

#include "core/executor.hpp"
#include "core/result.hpp"
#include "fractal/reconstruction/cell_samples.hpp"
#include "fractal/reconstruction/temperature.hpp"

namespace scree::fractal {

struct SzeliskiOptions {
  Temperature temperature = {};
  int sweeps = 50;     ///< of every level
  bool tuned = false;  ///< rows as vectors (gibbs_rows.hpp): the same law in another order, with other random numbers
};

/// Levels of halved resolution, u_l = I·u_(l+1) + v_l with I bilinear, coarsest at most 2 × 2 cells. Level by level
/// from the coarsest, v_l is relaxed by Gauss–Seidel sweeps (T = 0) or drawn by Gibbs sweeps from exp(−½v'Av/T_l −
/// ½Σc(u − d)²), T_l = T0·2^(2lH), u_(l+1) being frozen; d and c of a coarse level are the weighted means and the sums
/// of 1/variance of its cells. A is the blend of temperature.hpp, the same on every level: in cells, eq. 8 says no more
/// than T_l does, and both together would count the law of scales twice.
///
/// mean_m: the relaxation; it is the expectation of the draws after the same number of sweeps. draws: Gibbs samples.
/// sd_m: spread of max(draws, 8) of them; NaN at T = 0, where all draws are the mean. iterations: sweeps of one surface
/// over all levels. One law: a varying one is refused. Errors: those of check_surface; usage (sweeps < 1, a
/// temperature beyond a millionth or a million of the squared change over one cell).
/// What is between the levels' frozen choices and a sample of the posterior stays between them however many sweeps
/// there are: docs/reconstruction.md. Cost: sweeps · 1.33 cells · (draws + 1), 18 ns each (tuned 2.5).
/// Memory: 40 bytes a cell and 20 for each draw that is made at once (4 at most). Sources: [AK96] sections 3.2–3.4,
/// [Sz89].
Result<SurfaceEstimate> reconstruct_szeliski(const CellSamples& samples, const SurfaceRequest& request,
                                             const SzeliskiOptions& options, Executor& executor);

}  // namespace scree::fractal
