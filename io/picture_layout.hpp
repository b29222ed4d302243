#pragma once
// What a map picture shows where, without drawing: the part worth showing, ticks, value limits, relief.

#include <string>
#include <utility>
#include <vector>

#include "core/grid.hpp"

namespace scree::io {

/// A block of cells.
struct CellBlock {
  int row = 0;
  int column = 0;
  int rows = 0;
  int columns = 0;
};

/// The square block around everything known in any of the grids, with a margin, within the grids; all of them when
/// nothing is known. All grids have one shape.
CellBlock known_block(const std::vector<const Grid<float>*>& grids);

Grid<float> cut(const Grid<float>& grid, const CellBlock& block);

/// Ticks at 1, 2 or 5 · 10^n in [min, max], at most `most` of them, and their labels.
struct Tick {
  double value = 0.0;
  std::string label;
};
std::vector<Tick> ticks(double min, double max, int most);

/// The greatest 1, 2 or 5 · 10^n up to `most` > 0.
Tick round_length(double most);

/// 1 % and 99 % quantiles of the finite values, widened where they coincide; {0, 1} when there are none.
std::pair<double, double> value_limits(const Grid<float>& values);

/// Brightness 0 … 1 of heights lit from the north-west at 45°; level ground has 0.707, unknown too. Slopes at the edge
/// of the known are one-sided.
Grid<float> hillshade(const Grid<float>& height_m, double cell_m);

/// OpenCV's letters are ASCII: × becomes x, ± +-, dashes and … three dots; other letters are left out.
std::string ascii_text(const std::string& text);

}  // namespace scree::io
