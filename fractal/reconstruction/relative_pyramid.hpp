#pragma once
// The problem of the relative multiresolution representation on every level.

#include <vector>

#include "fractal/reconstruction/cell_samples.hpp"
#include "fractal/reconstruction/gibbs_level.hpp"

namespace scree::fractal {

/// Data and prior of every level, finest first, heights in units of `unit_m` less `offset_m`. `right` of the levels is
/// not set: it depends on the surface above.
struct RelativePyramid {
  struct Level {
    GibbsLevel gibbs;
    Grid<float> datum;  ///< where gibbs.precision > 0
  };
  std::vector<Level> levels;
  double unit_m = 1.0, offset_m = 0.0;
};

/// Prior precision of level l: the blend of D at kSzeliskiWavenumber over relative_temperature · 2^(2lH), in units of
/// the rms change over one cell. At least one cell measured; relative_temperature > 0.
RelativePyramid make_pyramid(const CellSamples& samples, const FractalLaw& law, double cell_m,
                             double relative_temperature);

/// Bilinear between cell centres (3/4, 1/4), flat beyond the outermost: `fine` has its shape set, each side 2n or 2n −
/// 1 of the coarse n.
void interpolate(const Grid<float>& coarse, Grid<float>& fine);

}  // namespace scree::fractal
