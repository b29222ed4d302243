#include "fractal/bit_plane.hpp"

#include <algorithm>
#include <bit>

namespace scree::fractal {
namespace {

/// Adds to `to` the row `from` with bit c taken from c + dx. 0 < |dx| < 64; the rows do not overlap.
void add_moved(const std::uint64_t* from, std::uint64_t* to, std::size_t words, int dx) {
  const auto shift = static_cast<unsigned>(dx > 0 ? dx : -dx);
  for (std::size_t i = 0; i < words; ++i)
    if (dx > 0)
      to[i] |= (from[i] >> shift) | (i + 1 < words ? from[i + 1] << (64 - shift) : 0);
    else
      to[i] |= (from[i] << shift) | (i > 0 ? from[i - 1] >> (64 - shift) : 0);
}

}  // namespace

void BitPlane::assign(int rows, int columns) {
  rows_ = rows;
  columns_ = columns;
  words_a_row_ = (static_cast<std::size_t>(columns) + 63) / 64;
  words_.assign(static_cast<std::size_t>(rows) * words_a_row_, 0);
}

void BitPlane::clear_beyond_columns() {
  if (columns_ % 64 == 0) return;
  const std::uint64_t inside = (std::uint64_t{1} << (columns_ % 64)) - 1;
  for (int r = 0; r < rows_; ++r) row_words(r)[words_a_row_ - 1] &= inside;
}

void BitPlane::set_box(int top, int bottom, int left, int right) {
  for (int r = std::max(0, top); r < std::min(rows_, bottom); ++r)
    for (int c = std::max(0, left); c < std::min(columns_, right); ++c) set(r, c);
}

void BitPlane::add(const BitPlane& other) {
  for (std::size_t i = 0; i < words_.size(); ++i) words_[i] |= other.words_[i];
}

bool BitPlane::any() const {
  return std::any_of(words_.begin(), words_.end(), [](std::uint64_t w) { return w != 0; });
}

void BitPlane::dilate(int radius) {
  for (int reach = 0; reach < radius;) {
    // What is set is filled to `reach` around each cell, as far as the plane goes: copies moved by one more leave no
    // gap.
    const int step = std::min({reach + 1, radius - reach, 63});
    before_ = words_;
    for (int r = 0; r < rows_; ++r)
      for (const int dx : {step, -step}) add_moved(before_row(r), row_words(r), words_a_row_, dx);
    before_ = words_;
    for (int r = 0; r < rows_; ++r)
      for (const int other : {r - step, r + step})
        if (other >= 0 && other < rows_)
          for (std::size_t i = 0; i < words_a_row_; ++i) row_words(r)[i] |= before_row(other)[i];
    reach += step;
  }
  clear_beyond_columns();
}

BitPlane BitPlane::moved(int dx) const {
  if (dx == 0) return *this;
  BitPlane out(rows_, columns_);
  for (int r = 0; r < rows_; ++r) add_moved(row_words(r), out.row_words(r), words_a_row_, dx);
  out.clear_beyond_columns();
  return out;
}

BitPlane::Span BitPlane::span(int row) const {
  const std::uint64_t* words = row_words(row);
  std::size_t first = 0, last = words_a_row_;
  while (first < last && words[first] == 0) ++first;
  if (first == last) return {};
  while (words[last - 1] == 0) --last;
  return {static_cast<int>(64 * first) + std::countr_zero(words[first]),
          static_cast<int>(64 * last) - std::countl_zero(words[last - 1])};
}

}  // namespace scree::fractal
