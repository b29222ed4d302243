#pragma once
// The blend prior of a law that varies over the map.

#include <vector>

#include "fractal/reconstruction/blend_field.hpp"
#include "fractal/reconstruction/law_pyramid.hpp"
#include "fractal/reconstruction/multigrid.hpp"

namespace scree::fractal {

struct PriorScale {
  double unit_m = 1.0;  ///< of the heights that the prior is for
  double cell_m = 0.1;
  double spacing_cells = 4.5;  ///< of the data
};

/// w1 and w2 of each cell by the closed form for its own D (blend_wavenumber(D) included) over its own σ². D and log σ
/// are smoothed (sd 8 cells, as means of blocks of 4): calibration holds for any prior, but noise in the estimates of
/// D(x) makes one that errs in holes (docs/reconstruction.md). Keeps its buffers: no allocation when the shape is
/// unchanged.
class VaryingPrior {
 public:
  /// `prior` padded to `shape` with copies of the border. `law` varies and lies at `window`. Returns the smallest D.
  double set(const LawMap& law, const LatticeWindow& window, const PriorScale& scale, const MultigridShape& shape,
             BlendField& prior);

  /// Where a cell lies between the middles of blocks.
  struct Place {
    int below;
    float share;
  };

 private:
  void spread(const Grid<float>& blocks, CellIndex offset, PaddedField& out);

  LawPyramid pyramid_;
  Grid<float> log_sigma_, hurst_, scratch_;
  Grid<float> w1_, w2_;  ///< at the middles of blocks
  std::vector<float> line_;
  std::vector<Place> places_;
};

}  // namespace scree::fractal
