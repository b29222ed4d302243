#pragma once
// Dense grids and the world lattice their cells live on.

#include <cassert>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace scree {

/// A dense rows × columns array, row-major. For maps row 0 is the smallest y and column 0 the smallest x
/// (OccupancyGrid order); for range images row 0 is the top of the image.
template <class T>
class Grid {
 public:
  Grid() = default;
  Grid(int rows, int columns, T fill = T{})
      : rows_(rows),
        columns_(columns),
        cells_(static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns), fill) {}

  int rows() const { return rows_; }
  int columns() const { return columns_; }
  std::size_t size() const { return cells_.size(); }
  bool empty() const { return cells_.empty(); }
  bool contains(int row, int column) const { return row >= 0 && row < rows_ && column >= 0 && column < columns_; }

  T& operator()(int row, int column) { return cells_[index(row, column)]; }
  const T& operator()(int row, int column) const { return cells_[index(row, column)]; }
  T& operator[](std::size_t i) { return cells_[i]; }
  const T& operator[](std::size_t i) const { return cells_[i]; }

  std::span<T> row(int r) { return {cells_.data() + index(r, 0), static_cast<std::size_t>(columns_)}; }
  std::span<const T> row(int r) const { return {cells_.data() + index(r, 0), static_cast<std::size_t>(columns_)}; }
  T* data() { return cells_.data(); }
  const T* data() const { return cells_.data(); }
  auto begin() { return cells_.begin(); }
  auto end() { return cells_.end(); }
  auto begin() const { return cells_.begin(); }
  auto end() const { return cells_.end(); }

  /// Sets the shape and every cell; keeps the allocation where it suffices.
  void assign(int rows, int columns, T fill) {
    rows_ = rows;
    columns_ = columns;
    cells_.assign(static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns), fill);
  }

  /// Sets the shape; what the cells hold is anything if it was another one. For grids that are written whole.
  void reshape(int rows, int columns) {
    if (rows != rows_ || columns != columns_) assign(rows, columns, T{});
  }

  friend bool operator==(const Grid&, const Grid&) = default;

 private:
  std::size_t index(int row, int column) const {
    assert(row >= 0 && row < rows_ && column >= 0 && column < columns_);
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(column);
  }

  int rows_ = 0;
  int columns_ = 0;
  std::vector<T> cells_;
};

/// Index of a cell on the world lattice: cell (x, y) covers [x·cell_m, (x+1)·cell_m) × [y·cell_m, (y+1)·cell_m) of
/// the map frame. There is no float origin, hence no half-cell error.
struct CellIndex {
  std::int32_t x = 0;
  std::int32_t y = 0;
  friend bool operator==(const CellIndex&, const CellIndex&) = default;
};

/// The lattice cell that holds a map-frame coordinate in metres. |coordinate_m / cell_m| must be below 2^31.
inline std::int32_t lattice_coordinate(double coordinate_m, double cell_m) {
  return static_cast<std::int32_t>(std::floor(coordinate_m / cell_m));
}
inline CellIndex lattice_cell(double x_m, double y_m, double cell_m) {
  return {lattice_coordinate(x_m, cell_m), lattice_coordinate(y_m, cell_m)};
}

/// A rectangle of the lattice: cells min.x … min.x+columns−1 by min.y … min.y+rows−1.
struct LatticeWindow {
  CellIndex min;
  int rows = 0;
  int columns = 0;

  bool contains(CellIndex cell) const {
    return cell.x >= min.x && cell.x - min.x < columns && cell.y >= min.y && cell.y - min.y < rows;
  }
  friend bool operator==(const LatticeWindow&, const LatticeWindow&) = default;
};

}  // namespace scree
