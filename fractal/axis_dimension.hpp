#pragma once
// D of a dense grid by the plainest estimator: the one that reconstructions are compared by.

#include "core/grid.hpp"

namespace scree::fractal {

/// D = 3 − slope of the log mean absolute height change along rows and columns against the log lag, lags 1 … `lags`
/// cells, unweighted. Pairs with a NaN are left out; NaN without a pair for some lag, or where one has no change. Tilt
/// and noise are part of it. Cost: O(cells · lags). Source: [Y89].
double axis_dimension(const Grid<float>& height_m, int lags = 16);

}  // namespace scree::fractal
