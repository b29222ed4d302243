#include "fractal/directed_increments.hpp"

#include <algorithm>
#include <bit>

#include "core/simd.hpp"

namespace scree::fractal {
namespace {

SCREE_CLONES std::int64_t common_bits(const std::uint64_t* a, const std::uint64_t* b, std::size_t words) {
  std::int64_t sum = 0;
  for (std::size_t i = 0; i < words; ++i) sum += std::popcount(a[i] & b[i]);
  return sum;
}

}  // namespace

DirectedEnergies directed_energies(const MaskedHeights& heights) {
  DirectedEnergies out;
  for (std::size_t d = 0; d < kDirectedSteps.size(); ++d) {
    const std::ptrdiff_t step =
        static_cast<std::ptrdiff_t>(kDirectedSteps[d].dy) * heights.stride() + kDirectedSteps[d].dx;
    out.complete[d] = BitPlane(heights.rows, heights.columns);
    for (int r = 0; r < heights.rows; ++r)
      for (int c = 0; c < heights.columns; ++c) {
        const std::ptrdiff_t at = heights.offset(r, c);
        const float* z = heights.height.data() + at;
        const float* m = heights.mask.data() + at;
        if (m[0] * m[step] * m[-step] == 0.0F) continue;
        const double change = static_cast<double>((z[step] - z[0]) + (z[-step] - z[0]));
        out.mean_square_m2[d] += change * change;
        out.count[d] += 1.0;
        out.complete[d].set(r, c);
      }
    if (out.count[d] > 0.0) out.mean_square_m2[d] /= out.count[d];
  }
  return out;
}

std::vector<double> pair_counts(const BitPlane& first, const BitPlane& second, int reach) {
  const int side = 2 * reach + 1, rows = first.rows();
  const std::size_t words = first.words_a_row();
  const int stride = std::max(1, static_cast<int>(static_cast<std::size_t>(rows) * words * 64 >> 20));
  const double scale = static_cast<double>(rows) / ((rows + stride - 1) / stride);
  std::vector<double> counts(static_cast<std::size_t>(side) * static_cast<std::size_t>(side), 0.0);
  for (int ox = -reach; ox <= reach; ++ox) {
    const BitPlane moved = second.moved(ox);
    for (int oy = -reach; oy <= reach; ++oy) {
      std::int64_t sum = 0;
      for (int r = 0; r < rows; r += stride)
        if (r + oy >= 0 && r + oy < rows) sum += common_bits(first.row_words(r), moved.row_words(r + oy), words);
      counts[static_cast<std::size_t>((oy + reach) * side + ox + reach)] = scale * static_cast<double>(sum);
    }
  }
  return counts;
}

}  // namespace scree::fractal
