#pragma once
// One bit a cell.

#include <cstddef>
#include <cstdint>
#include <vector>

namespace scree::fractal {

/// Rows of 64-bit words; bits beyond the last column are 0.
class BitPlane {
 public:
  BitPlane() = default;
  BitPlane(int rows, int columns) { assign(rows, columns); }
  /// Sets the shape and clears every bit; keeps the allocation where it suffices.
  void assign(int rows, int columns);

  int rows() const { return rows_; }
  int columns() const { return columns_; }
  void set(int row, int column) { word(row, column) |= std::uint64_t{1} << (column % 64); }
  bool test(int row, int column) const { return row_words(row)[column / 64] >> (column % 64) & 1; }
  /// Sets the cells of rows [top, bottom) × columns [left, right), cut to the plane.
  void set_box(int top, int bottom, int left, int right);
  /// Adds the bits of a plane of the same shape.
  void add(const BitPlane& other);
  bool any() const;
  /// Sets every cell within `radius` (maximum norm) of a set one. Cost: about 2·log2(radius) word operations a word.
  void dilate(int radius);
  /// This plane moved by `dx` columns: bit (r, c) of the result is bit (r, c + dx) of this. |dx| < 64.
  BitPlane moved(int dx) const;

  const std::uint64_t* row_words(int r) const { return words_.data() + static_cast<std::size_t>(r) * words_a_row_; }
  std::uint64_t* row_words(int r) { return words_.data() + static_cast<std::size_t>(r) * words_a_row_; }
  std::size_t words_a_row() const { return words_a_row_; }
  /// Columns from the first to beyond the last set bit of a row; {0, 0} when there is none.
  struct Span {
    int begin = 0, end = 0;
  };
  Span span(int row) const;

 private:
  std::uint64_t& word(int row, int column) { return row_words(row)[column / 64]; }
  void clear_beyond_columns();
  const std::uint64_t* before_row(int r) const { return before_.data() + static_cast<std::size_t>(r) * words_a_row_; }
  int rows_ = 0, columns_ = 0;
  std::size_t words_a_row_ = 0;
  std::vector<std::uint64_t> words_;
  std::vector<std::uint64_t> before_;  // work space of dilate
};

}  // namespace scree::fractal
