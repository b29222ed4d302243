#pragma once
// Autocorrelations of what lies on a lattice, by Fourier transforms: all pairs of cells at once.

#include <complex>

#include "core/executor.hpp"
#include "core/grid.hpp"

namespace scree::fractal {

/// What lies in the cells: n points with Σz = s and Σz² = q.
struct LatticeDeposit {
  Grid<std::complex<double>> count_square;  ///< n + i·q
  Grid<double> sum;                         ///< s
};

/// The lattice padded by the longest offset wanted, so that nothing wraps around.
struct LatticeShape {
  int rows = 0, columns = 0;
  int reach_rows = 0, reach_columns = 0;  ///< longest offsets
  int side_y = 0, side_x = 0;             ///< lengths of the transforms

  LatticeShape(int lattice_rows, int lattice_columns, double reach_cells);
};

/// By offset, as real and imaginary part: Σ(z − z')² = n⋆q + q⋆n − 2 s⋆s and the number of pairs n⋆n. Given transformed
/// back along y only, unnormalised: element (kx, offset y mod side_y), kx = 0 … side_x/2; both parts are real and even,
/// so element (−kx, y) is (kx, −y). Cost: O(cells log cells), 3 complex numbers a padded cell.
Grid<std::complex<double>> lattice_correlation(const LatticeShape& shape, const LatticeDeposit& deposit,
                                               Executor& executor);

}  // namespace scree::fractal
