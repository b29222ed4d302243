#pragma once
// A window on the world lattice that moves without moving its contents.

#include <array>
#include <cassert>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "core/grid.hpp"

namespace scree {

/// Toroidal storage: lattice cell (x, y) lives in slot (y mod rows, x mod columns) for as long as the window holds it,
/// so following a robot costs only the rows and columns that enter. Row and column numbers are the window's (row 0 is
/// the smallest y); what leaves the window is forgotten.
template <class T>
class RollingGrid {
 public:
  /// `empty` is what an entering cell holds. rows, columns > 0.
  RollingGrid(int rows, int columns, T empty) : slots_(rows, columns, empty), empty_(empty) {
    window_.rows = rows;
    window_.columns = columns;
  }

  const LatticeWindow& window() const { return window_; }

  T& operator()(int row, int column) { return slots_(slot_row(row), slot_column(column)); }
  const T& operator()(int row, int column) const { return slots_(slot_row(row), slot_column(column)); }

  /// The cell at a lattice index inside the window.
  T& at(CellIndex cell) {
    assert(window_.contains(cell));
    return (*this)(cell.y - window_.min.y, cell.x - window_.min.x);
  }
  const T& at(CellIndex cell) const { return const_cast<RollingGrid&>(*this).at(cell); }

  /// One row of the window as its two contiguous pieces, in column order (the second may be empty).
  std::array<std::span<const T>, 2> row_pieces(int row) const {
    const auto slots = slots_.row(slot_row(row));
    const auto first = static_cast<std::size_t>(first_column_);
    return {slots.subspan(first), slots.first(first)};
  }

  /// What was known of lattice cell (x, y) is from now on known of (x + by.x, y + by.y): the window moves with its
  /// contents. O(1).
  void relabel(CellIndex by) {
    label_.x += by.x;
    label_.y += by.y;
    window_.min.x += by.x;
    window_.min.y += by.y;
  }

  /// Moves the window so that `min` is its smallest corner; entering cells become `empty`.
  void roll_to(CellIndex min) {
    const std::int64_t dx = std::int64_t{min.x} - window_.min.x;
    const std::int64_t dy = std::int64_t{min.y} - window_.min.y;
    if (std::abs(dx) >= window_.columns || std::abs(dy) >= window_.rows) {
      slots_.assign(window_.rows, window_.columns, empty_);
      place(min);
      return;
    }
    place(min);
    const int columns = static_cast<int>(std::abs(dx));
    const int rows = static_cast<int>(std::abs(dy));
    const int first_column = dx > 0 ? window_.columns - columns : 0;
    const int first_row = dy > 0 ? window_.rows - rows : 0;
    for (int row = 0; row < window_.rows; ++row) {
      const bool enters = row >= first_row && row < first_row + rows;
      const int begin = enters ? 0 : first_column;
      const int end = enters ? window_.columns : first_column + columns;
      for (int column = begin; column < end; ++column) (*this)(row, column) = empty_;
    }
  }

 private:
  static int floor_mod(std::int32_t a, int n) {
    const int r = a % n;
    return r < 0 ? r + n : r;
  }
  void place(CellIndex min) {
    window_.min = min;
    first_row_ = floor_mod(min.y - label_.y, window_.rows);
    first_column_ = floor_mod(min.x - label_.x, window_.columns);
  }
  int slot_row(int row) const {
    const int slot = first_row_ + row;
    return slot < window_.rows ? slot : slot - window_.rows;
  }
  int slot_column(int column) const {
    const int slot = first_column_ + column;
    return slot < window_.columns ? slot : slot - window_.columns;
  }

  LatticeWindow window_;
  CellIndex label_{0, 0};  ///< what relabel() has added up to
  int first_row_ = 0;      ///< slot of the window's row 0
  int first_column_ = 0;
  Grid<T> slots_;
  T empty_;
};

}  // namespace scree
