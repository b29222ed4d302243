#pragma once
// Draws of a method in batches, in turn, and their spread.

#include <functional>

#include "core/executor.hpp"
#include "fractal/reconstruction/surface_problem.hpp"

namespace scree::fractal {

/// Makes draw k of the method into `draw_m`, which has the shape of the grid. Called from several threads at once, for
/// different k.
using MakeDraw = std::function<void(int k, Grid<float>& draw_m)>;

/// Spreads of methods rest on this many draws at least, whatever is asked for.
inline constexpr int kMinSpreadDraws = 8;

/// Makes max(request.draws, kMinSpreadDraws) draws, kDrawBatch at a time; hands the first request.draws to
/// request.on_draw in turn; reports progress; returns the root of their mean squared deviation from `mean_m`, the
/// expectation of the draws (so there is no degree of freedom to take off). Memory: (kDrawBatch + 2) grids.
/// Deterministic: sums go by k.
Grid<float> spread_of_draws(const SurfaceRequest& request, const Grid<float>& mean_m, const MakeDraw& make,
                            Executor& executor);

inline constexpr int kDrawBatch = 4;

}  // namespace scree::fractal
