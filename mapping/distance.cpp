#include "mapping/distance.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/executor.hpp"
#include "core/simd.hpp"

namespace scree::mapping {

namespace {

constexpr float kFar = std::numeric_limits<float>::infinity();

// out[x] = min(out[x], in[x] + add)
SCREE_CLONES void lower_row(const float* in, float add, int n, float* out) {
  for (int x = 0; x < n; ++x) {
    const float candidate = in[x] + add;
    out[x] = candidate < out[x] ? candidate : out[x];
  }
}

}  // namespace

void BoundedDistance::transform(const Grid<std::uint8_t>& set, int limit_cells, Executor& executor,
                                Grid<float>& squared_cells) {
  const int rows = set.rows();
  const int columns = set.columns();
  const int limit = std::max(limit_cells, 0);
  vertical_.assign(rows, columns + 2 * limit, kFar);
  squared_cells.assign(rows, columns, kFar);
  for_rows(executor, rows, [&](int begin, int end) {
    for (int row = begin; row < end; ++row) {
      float* out = vertical_.row(row).data() + limit;
      for (int offset = -limit; offset <= limit; ++offset) {
        if (row + offset < 0 || row + offset >= rows) continue;
        const auto from = set.row(row + offset);
        const auto distance2 = static_cast<float>(offset * offset);
        for (std::size_t x = 0; x < from.size(); ++x)
          if (from[x] != 0 && distance2 < out[x]) out[x] = distance2;
      }
    }
  });
  const auto limit2 = static_cast<float>(limit * limit);
  for_rows(executor, rows, [&](int begin, int end) {
    for (int row = begin; row < end; ++row) {
      float* out = squared_cells.row(row).data();
      const float* in = vertical_.row(row).data();
      for (int offset = -limit; offset <= limit; ++offset)
        lower_row(in + limit + offset, static_cast<float>(offset * offset), columns, out);
      for (int x = 0; x < columns; ++x)
        if (out[x] > limit2) out[x] = kFar;
    }
  });
}

void Closing::close(const Grid<std::uint8_t>& set, double reach_cells, Executor& executor, Grid<std::uint8_t>& closed) {
  const int limit = static_cast<int>(std::ceil(reach_cells));
  const auto reach2 = static_cast<float>(reach_cells * reach_cells);
  distance_.transform(set, limit, executor, squared_);
  outside_.assign(set.rows(), set.columns(), 0);
  for (std::size_t i = 0; i < squared_.size(); ++i) outside_[i] = squared_[i] > reach2 ? 1 : 0;
  distance_.transform(outside_, limit, executor, squared_);
  closed.assign(set.rows(), set.columns(), 0);
  for (std::size_t i = 0; i < squared_.size(); ++i) closed[i] = (squared_[i] > reach2 || set[i] != 0) ? 1 : 0;
}

}  // namespace scree::mapping
