#include "drivers/frame/neighbour_filter.hpp"

#include <cstddef>

namespace scree {
namespace {

constexpr int kLongestRun = 3;  // steps: at most two mixed pixels beside each other

/// One row or column of the image: pixel i at range[i · stride], edge i leads from pixel i to i + 1.
struct ImageLine {
  const float* range;
  const std::uint8_t* edges;
  std::ptrdiff_t stride;
  int size;
  float ambiguity_m;

  std::uint8_t edge_bits(int i) const { return i < 0 || i + 1 >= size ? std::uint8_t{0} : edges[i * stride]; }
  bool steep(int i) const { return (edge_bits(i) & (edge::kPresent | edge::kClose)) == edge::kPresent; }
  bool rises(int i) const {
    const float wrapped = static_cast<float>(edge::wraps(edge_bits(i))) * ambiguity_m;
    return range[(i + 1) * stride] - range[i * stride] - wrapped > 0.0F;
  }
};

bool between_surfaces(const ImageLine& line, int pixel) {
  if (!line.steep(pixel - 1) || !line.steep(pixel)) return false;
  const bool rising = line.rises(pixel);
  if (line.rises(pixel - 1) != rising) return false;
  int first = pixel - 1;  // edges [first, last] are the run
  int last = pixel;
  while (last - first < kLongestRun && line.steep(first - 1) && line.rises(first - 1) == rising) --first;
  while (last - first < kLongestRun && line.steep(last + 1) && line.rises(last + 1) == rising) ++last;
  return last - first < kLongestRun && !line.steep(first - 1) && !line.steep(last + 1);
}

struct NeighbourRule {
  bool mixed;
  int support;  ///< joined neighbours needed; 0 = speckle filter off
};

PixelState judge(const NeighbourRule& rule, const ImageLine& row, int c, const ImageLine& column, int r) {
  if (rule.mixed && (between_surfaces(row, c) || between_surfaces(column, r))) return PixelState::mixed;
  if (rule.support == 0) return PixelState::kept;
  int joined = 0;
  int close = 0;
  for (const std::uint8_t bits :
       {row.edge_bits(c - 1), row.edge_bits(c), column.edge_bits(r - 1), column.edge_bits(r)}) {
    joined += bits & edge::kJoined;
    close |= bits & edge::kClose;
  }
  return joined < rule.support || close == 0 ? PixelState::speckle : PixelState::kept;
}

}  // namespace

void reject_by_neighbours(const Grid<float>& range_m, const ImageEdges& edges, const RayTables& tables,
                          Executor& executor, Grid<PixelState>& state) {
  const int rows = range_m.rows();
  const int columns = range_m.columns();
  const FilterConfig& filter = tables.sensor->filter;
  const int available = rows > 1 && columns > 1 ? 2 : 1;  // the end of a line scanner has one neighbour only
  const NeighbourRule rule{filter.mixed_pixels, filter.speckle_min_pixels > 0 ? available : 0};
  if (!rule.mixed && rule.support == 0) return;
  const float ambiguity = static_cast<float>(tables.projection->ambiguity_m);
  for_rows(executor, rows, [&](int begin, int end) {
    for (int r = begin; r < end; ++r) {
      const ImageLine row{range_m.row(r).data(), edges.right.row(r).data(), 1, columns, ambiguity};
      for (int c = 0; c < columns; ++c) {
        if (state(r, c) != PixelState::kept) continue;
        const ImageLine column{range_m.data() + c, edges.down.data() + c, columns, rows, ambiguity};
        state(r, c) = judge(rule, row, c, column, r);
      }
    }
  });
}

}  // namespace scree
