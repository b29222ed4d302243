#pragma once
// Mean and spread of a method's own realisations.

#include <functional>

#include "core/executor.hpp"
#include "core/grid.hpp"
#include "fractal/reconstruction/surface_problem.hpp"

namespace scree::fractal {

/// What sd_m of a method without an error model is made of, at least.
inline constexpr int kLeastRealisations = 8;

inline int realisation_count(const SurfaceRequest& request) {
  return request.draws > kLeastRealisations ? request.draws : kLeastRealisations;
}

/// Calls `make(k, grid)` for realisations k = 0 … realisation_count() − 1, a few at a time through the executor (each
/// fills the grid it is given, all NaN at first, and must not depend on other calls); hands the first `draws` to
/// request.on_draw in order; returns their mean and sd (n − 1 in the denominator), NaN in a cell where any is NaN.
/// Memory: mean, sd and two to four grids.
SurfaceEstimate estimate_from_realisations(const SurfaceRequest& request, Executor& executor,
                                           const std::function<void(int k, Grid<float>& out)>& make);

}  // namespace scree::fractal
