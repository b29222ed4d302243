#pragma once
// Where a residual solve starts that has nothing to start from.

#include "fractal/reconstruction/padded_field.hpp"

namespace scree::fractal {

/// x = means of u over blocks of 2^l cells, twice the spacing of the data or about so, interpolated bilinearly. The
/// solution A⁻¹(c·u + √c·n) is u without what the data cannot see: from 0 the long waves must be found, in holes last,
/// and until then the residual is too large; from u the roughness must be taken out, and until then it is too small.
/// From the means most of both is there: fewer cycles to a smaller error of the variance (docs/reconstruction.md).
/// Shapes equal. Cost: 1 ns a cell.
void start_from_means(const PaddedField& u, double spacing_cells, PaddedField& x);

}  // namespace scree::fractal
