#include "fractal/reconstruction/distance_transform.hpp"

#include <algorithm>
#include <cassert>
#include <functional>

#include "core/simd.hpp"

namespace scree::fractal {
namespace {

constexpr std::int32_t kNone = DistanceTransform::kNone;
constexpr std::int32_t kNoStep = 1 << 20;

/// steps[i] = 0 where set, else one more than in the row before.
SCREE_CLONES void step_down(const std::uint8_t* set, const std::int32_t* before, std::int32_t* steps, int n) {
  for (int i = 0; i < n; ++i) steps[i] = set[i] != 0 ? 0 : before[i] + 1;
}

SCREE_CLONES void step_up(const std::int32_t* __restrict after, std::int32_t* __restrict steps, int n) {
  for (int i = 0; i < n; ++i) steps[i] = std::min(steps[i], after[i] + 1);
}

SCREE_CLONES void square(std::int32_t* steps, int n) {
  for (int i = 0; i < n; ++i) steps[i] = steps[i] >= kNoStep ? kNone : steps[i] * steps[i];
}

SCREE_CLONES void lower(const std::int32_t* __restrict f, std::int32_t add, std::int32_t* __restrict out, int n) {
  for (int i = 0; i < n; ++i) out[i] = std::min(out[i], f[i] + add);
}

SCREE_CLONES std::int32_t largest(const std::int32_t* f, int n) {
  std::int32_t most = 0;
  for (int i = 0; i < n; ++i) most = std::max(most, f[i]);
  return most;
}

/// out[x] = min over i of f[i] + (x − i)².
void lower_envelope(const std::int32_t* f, int n, std::int32_t* vertex, std::int32_t* start, std::int32_t* out) {
  const auto at = [f](std::int32_t x, std::int32_t i) { return f[i] + (x - i) * (x - i); };
  int top = 0;
  vertex[0] = start[0] = 0;
  for (std::int32_t u = 1; u < n; ++u) {
    while (top >= 0 && at(start[top], vertex[top]) > at(start[top], u)) --top;
    if (top < 0) {
      top = 0;
      vertex[0] = u;
      start[0] = 0;
      continue;
    }
    const std::int32_t i = vertex[top];
    const std::int32_t from = 1 + (u * u - i * i + f[u] - f[i]) / (2 * (u - i));  // the first x where u is lower
    if (from >= n) continue;
    ++top;
    vertex[top] = u;
    start[top] = from;
  }
  for (std::int32_t x = n - 1; x >= 0; --x) {
    out[x] = at(x, vertex[top]);
    if (x == start[top]) --top;
  }
}

}  // namespace

void DistanceTransform::transform(const Grid<std::uint8_t>& set, Executor& executor,
                                  Grid<std::int32_t>& squared_cells) {
  const int rows = set.rows(), columns = set.columns();
  assert(std::max(rows, columns) <= kMaxSide);
  for (Grid<std::int32_t>* grid : {&squared_, &vertex_, &start_, &squared_cells})
    if (grid->rows() != rows || grid->columns() != columns) grid->assign(rows, columns, kNone);
  if (set.empty()) return;

  const auto columns_pass = [&](int begin, int end) {
    const int n = end - begin;
    const auto steps = [&](int r) { return squared_.row(r).data() + begin; };
    std::fill_n(steps(0), n, kNoStep);
    for (int r = 0; r < rows; ++r) step_down(set.row(r).data() + begin, steps(std::max(r - 1, 0)), steps(r), n);
    for (int r = rows - 2; r >= 0; --r) step_up(steps(r + 1), steps(r), n);
    for (int r = 0; r < rows; ++r) square(steps(r), n);
  };
  const auto rows_pass = [&](int begin, int end) {
    for (int r = begin; r < end; ++r) {
      const std::int32_t* f = squared_.row(r).data();
      std::int32_t* out = squared_cells.row(r).data();
      std::copy_n(f, columns, out);
      int reach = 1;
      while (reach < columns && reach <= kDirect && largest(out, columns) > reach * reach) {
        lower(f, reach * reach, out + reach, columns - reach);
        lower(f + reach, reach * reach, out, columns - reach);
        ++reach;
      }
      if (reach > kDirect) lower_envelope(f, columns, vertex_.row(r).data(), start_.row(r).data(), out);
      for (int c = 0; c < columns; ++c) out[c] = std::min(out[c], kNone);
    }
  };
  for_rows(executor, columns, columns_pass);
  for_rows(executor, rows, rows_pass);
}

}  // namespace scree::fractal
