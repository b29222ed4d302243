#include "fractal/azimuth_null.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace scree::fractal {
namespace {

constexpr std::array<double, 8> kSides = {16, 20, 28, 40, 64, 100, 160, 256};
constexpr std::array<double, 5> kHursts = {0.1, 0.3, 0.5, 0.7, 0.9};

/// `anisotropy_bench --benchmark_filter=null`, counter V95: 1000 surfaces up to 100 cells, 300 above (standard errors
/// about 3 and 6 %). V is bounded by nothing where the mean H may be near 0.
constexpr std::array<std::array<double, kHursts.size()>, kSides.size()> kQuantiles = {{
    {5.767, 1.316, 0.821, 0.634, 0.554},
    {2.701, 0.845, 0.599, 0.489, 0.434},
    {1.256, 0.518, 0.395, 0.340, 0.305},
    {0.701, 0.350, 0.280, 0.246, 0.226},
    {0.358, 0.213, 0.178, 0.164, 0.154},
    {0.222, 0.141, 0.122, 0.111, 0.108},
    {0.139, 0.0960, 0.0806, 0.0742, 0.0712},
    {0.0854, 0.0592, 0.0517, 0.0509, 0.0465},
}};

struct Bracket {
  std::size_t below;
  double weight;  ///< of the node above
};
template <std::size_t N>
Bracket bracket(const std::array<double, N>& nodes, double value) {
  const double clipped = std::clamp(value, nodes.front(), nodes.back());
  std::size_t below = 0;
  while (below + 2 < N && nodes[below + 1] <= clipped) ++below;
  return {below, (clipped - nodes[below]) / (nodes[below + 1] - nodes[below])};
}

}  // namespace

double index_v_null95(double side_cells, double hurst) {
  if (!(side_cells >= kSides.front())) return std::numeric_limits<double>::quiet_NaN();
  std::array<double, kSides.size()> log_sides;
  std::transform(kSides.begin(), kSides.end(), log_sides.begin(), [](double side) { return std::log(side); });
  const Bracket s = bracket(log_sides, std::log(side_cells)), h = bracket(kHursts, hurst);
  const auto log_quantile = [&](std::size_t side) {
    const auto& row = kQuantiles[side];
    const double below = std::log(row[h.below]);
    return below + h.weight * (std::log(row[h.below + 1]) - below);
  };
  const double below = log_quantile(s.below);
  const double beyond = std::max(0.0, std::log(side_cells) - log_sides.back());
  return std::exp(below + s.weight * (log_quantile(s.below + 1) - below) - beyond);
}

}  // namespace scree::fractal
