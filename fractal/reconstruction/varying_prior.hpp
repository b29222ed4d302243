#pragma once
// The blend prior of a law that varies over the map.

#include "fractal/reconstruction/blend_field.hpp"
#include "fractal/reconstruction/law_pyramid.hpp"
#include "fractal/reconstruction/multigrid.hpp"

namespace scree::fractal {

struct PriorScale {
  double unit_m = 1.0;  ///< of the heights that the prior is for
  double cell_m = 0.1;
  double spacing_cells = 4.5;  ///< of the data
};

/// w1 and w2 of each cell by the closed form for its own D (blend_wavenumber(D) included) over its own σ², padded to
/// `shape` with copies of the border. D and log σ are smoothed (sd 8 cells, as means of blocks of 4): calibration holds
/// for any prior, but noise in the estimates of D(x) makes one that errs in holes (docs/reconstruction.md). `law`
/// varies and lies at `window`. Returns the smallest D. No allocation when the shape is unchanged but for the pyramid's
/// own.
double varying_prior(const LawMap& law, const LatticeWindow& window, const PriorScale& scale,
                     const MultigridShape& shape, BlendField& prior);

}  // namespace scree::fractal
