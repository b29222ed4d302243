#pragma once
// The classical smooth surfaces through data: membrane and thin plate.

#include <cstdint>

#include "core/executor.hpp"
#include "core/result.hpp"
#include "fractal/reconstruction/cell_samples.hpp"

namespace scree::fractal {

/// Most probable surface under a prior of one order only: minimum of w1·Σ|∇u|² (membrane) or w2·Σ(Δu)² (thin plate)
/// plus Σ(u − d)²/variance. The weight is that of a prior that has the fractal's spectrum at blend_wavenumber(D,
/// spacing): what it is hardly matters while the noise is small. Borders reflect (no flux; the thin plate's third
/// derivative across them is zero too), so constants alone cost nothing, also in the thin plate, whose planes are bent
/// level towards the borders: any one datum determines the surface, and with one it is level. (Natural borders would
/// leave planes free and need three data.) The border lies up to 2^levels − 1 cells outside (MultigridShape).
///
/// Neither is rough nor says how wrong it is: every draw is the mean and sd_m is NaN. Solved to a few thousandths of
/// the change over a cell; `iterations` are multigrid cycles. One law: a varying one is refused. Errors: those of
/// check_surface. Cost: some tens of cycles. Source: [Sz89]; [AK96] section 3.1.
Result<SurfaceEstimate> reconstruct_membrane(const CellSamples& samples, const SurfaceRequest& request,
                                             Executor& executor);
Result<SurfaceEstimate> reconstruct_thin_plate(const CellSamples& samples, const SurfaceRequest& request,
                                               Executor& executor);

}  // namespace scree::fractal
