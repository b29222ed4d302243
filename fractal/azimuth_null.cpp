#include "fractal/azimuth_null.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace scree::fractal {
namespace {

constexpr std::array<double, 8> kSides = {16, 20, 28, 40, 64, 100, 160, 256};
constexpr std::array<double, 5> kHursts = {0.1, 0.3, 0.5, 0.7, 0.9};

/// `anisotropy_bench --benchmark_filter=null`, counter V95: 2000 surfaces up to 100 cells, 400 above (standard errors
/// about 2 and 5 %). V is bounded by nothing where the mean H may be near 0.
constexpr std::array<std::array<double, kHursts.size()>, kSides.size()> kQuantiles = {{
    {6.961, 1.419, 0.875, 0.673, 0.573},
    {2.979, 0.905, 0.632, 0.513, 0.453},
    {1.353, 0.554, 0.413, 0.350, 0.315},
    {0.737, 0.368, 0.292, 0.255, 0.232},
    {0.394, 0.221, 0.185, 0.169, 0.155},
    {0.234, 0.150, 0.129, 0.116, 0.109},
    {0.151, 0.102, 0.086, 0.080, 0.075},
    {0.0845, 0.0604, 0.0549, 0.0515, 0.0465},
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
