#pragma once
// Fractal interpolation of regular samples by midpoints and noise.

#include "core/executor.hpp"
#include "core/result.hpp"
#include "fractal/reconstruction/cell_samples.hpp"

namespace scree::fractal {

/// The measured cells must be a square lattice: every 2^m-th row and column from some cell on, at least 2 × 2 of them,
/// none missing. Spacing is halved until it is one cell: the centre of four neighbours at distance δ gets their mean
/// plus √(1 − 2^(2H−2))·σ·δ^H·normal noise, first the centres of squares (δ = spacing/√2), then the middles of their
/// sides (δ = spacing/2; three neighbours, or the two of the side, at the border of the lattice). Samples are
/// interpolated exactly: their variances are not used. Cells beyond the lattice are NaN.
///
/// mean_m: without the noise, which is the expectation of the draws. sd_m: spread of max(draws, 8) of them. iterations:
/// halvings. One law: a varying one is refused. Errors: those of check_surface; bad_data where the samples are no such
/// lattice, with the first place that is not. Cost: O(cells) a draw. Source: [Y89]; [AK96] section 3.1.
Result<SurfaceEstimate> reconstruct_yokoya(const CellSamples& samples, const SurfaceRequest& request,
                                           Executor& executor);

}  // namespace scree::fractal
