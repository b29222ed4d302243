#pragma once
// What a cell's height stands for, and the variogram that follows from it.

namespace scree::fractal {

enum class Support {
  centre_point,  ///< the height at the exact centre of the cell (DEM posts, synthetic surfaces)
  block,         ///< the mean over the whole cell; k random points add a nugget γ̄(0)/(2k) to it
};

/// γ̄(o) = mean of |o + u − u'|^(2H) over u, u' uniform in the support, o = (dx, dy) in cells: the unit variogram of
/// cell values before the nugget. For a block γ̄(0) > 0: the variance within a cell is γ̄(0)/2. Exact to about 1e-9: the
/// corner singularity is integrated in closed form along rays. 0 < H < 1.
double mean_variogram(Support support, double hurst, int dx, int dy);

}  // namespace scree::fractal
