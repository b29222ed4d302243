#pragma once
// Samples that stand on a regular lattice of cells.

#include "core/result.hpp"
#include "fractal/reconstruction/cell_samples.hpp"

namespace scree::fractal {

/// Cells (row + i·step, column + j·step), 0 ≤ i < rows, 0 ≤ j < columns.
struct SampleLattice {
  int row = 0, column = 0, step = 1, rows = 0, columns = 0;
  int last_row() const { return row + (rows - 1) * step; }
  int last_column() const { return column + (columns - 1) * step; }
};

/// The lattice that the measured cells are: square, its step a power of two, at least 2 × 2, all of it measured and
/// nothing else. Errors: bad_data with the first cell that does not fit; `method` begins the message.
Result<SampleLattice> find_lattice(std::string_view method, const CellSamples& samples);

}  // namespace scree::fractal
