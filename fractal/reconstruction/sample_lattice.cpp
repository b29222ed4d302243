#include "fractal/reconstruction/sample_lattice.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <fmt/format.h>
#include <vector>

namespace scree::fractal {
namespace {

/// Rows (or columns) with a measured cell, in order.
template <class Measured>
std::vector<int> used_lines(int lines, int across, const Measured& measured) {
  std::vector<int> used;
  for (int i = 0; i < lines; ++i)
    for (int j = 0; j < across; ++j)
      if (measured(i, j)) {
        used.push_back(i);
        break;
      }
  return used;
}

Error no_lattice(std::string_view method, std::string found) {
  return {ErrorKind::bad_data,
          fmt::format("{}: expected samples on a square lattice of every 2nd, 4th, 8th … row and column (what is "
                      "irregular needs another method), found {}",
                      method, found)};
}

}  // namespace

Result<SampleLattice> find_lattice(std::string_view method, const CellSamples& samples) {
  const int rows = samples.height_m.rows(), columns = samples.height_m.columns();
  const auto measured = [&](int r, int c) { return !std::isnan(samples.height_m(r, c)); };
  const std::vector<int> used_rows = used_lines(rows, columns, measured);
  const std::vector<int> used_columns = used_lines(columns, rows, [&](int c, int r) { return measured(r, c); });
  if (used_rows.size() < 2 || used_columns.size() < 2)
    return no_lattice(method, fmt::format("them in {} rows and {} columns", used_rows.size(), used_columns.size()));

  const SampleLattice lattice{used_rows[0], used_columns[0], used_rows[1] - used_rows[0],
                              static_cast<int>(used_rows.size()), static_cast<int>(used_columns.size())};
  if (!std::has_single_bit(static_cast<unsigned>(lattice.step)))
    return no_lattice(method, fmt::format("a step of {} rows", lattice.step));
  for (std::size_t i = 1; i < used_rows.size(); ++i)
    if (used_rows[i] - used_rows[i - 1] != lattice.step)
      return no_lattice(method,
                        fmt::format("rows {} and {} after a step of {}", used_rows[i - 1], used_rows[i], lattice.step));
  for (std::size_t i = 1; i < used_columns.size(); ++i)
    if (used_columns[i] - used_columns[i - 1] != lattice.step)
      return no_lattice(method, fmt::format("columns {} and {} beside a step of {} rows", used_columns[i - 1],
                                            used_columns[i], lattice.step));
  for (const int r : used_rows)
    for (const int c : used_columns)
      if (!measured(r, c)) return no_lattice(method, fmt::format("none in row {}, column {}", r, c));
  return lattice;
}

}  // namespace scree::fractal
