#include "fractal/grid_energies.hpp"

#include <algorithm>
#include <cmath>

namespace scree::fractal {
namespace {

struct Cells {
  double known = 0.0, noise_m2 = 0.0, inverse_hits = 0.0;
  float largest_m = 0.0F;
  bool any_hits = false;
};

Cells sum_cells(const MaskedHeights& heights, const Grid<float>& variance_m2, const Grid<std::uint16_t>& hits) {
  Cells sum;
  for (int r = 0; r < heights.rows; ++r)
    for (int c = 0; c < heights.columns; ++c) {
      const auto at = static_cast<std::size_t>(heights.offset(r, c));
      if (heights.mask[at] == 0.0F) continue;
      sum.known += 1.0;
      sum.noise_m2 += std::max(0.0, static_cast<double>(variance_m2(r, c)));
      sum.inverse_hits += 1.0 / std::max<int>(hits(r, c), 1);
      sum.largest_m = std::max(sum.largest_m, std::abs(heights.height[at]));
      sum.any_hits |= hits(r, c) > 0;
    }
  return sum;
}

}  // namespace

GridEnergies grid_energies(const MaskedHeights& heights, const Grid<float>& variance_m2,
                           const Grid<std::uint16_t>& hits) {
  std::array<double, kClassCount> energy{}, count{};
  std::vector<float> row_energy(static_cast<std::size_t>(heights.columns)), row_count(row_energy.size());
  for (std::size_t c = 0; c < kClasses.size(); ++c)
    for (int r = 0; r < heights.rows; ++r) {
      increment_energies(heights, kClasses[c], kAllDirections, r, 0, heights.columns, row_energy, row_count);
      for (const float e : row_energy) energy[c] += static_cast<double>(e);
      for (const float k : row_count) count[c] += static_cast<double>(k);
    }
  const Cells cells = sum_cells(heights, variance_m2, hits);
  GridEnergies out;
  out.known = cells.known;
  out.support = cells.any_hits ? Support::block : Support::centre_point;
  out.enough = *std::min_element(count.begin(), count.end()) > 0.0;
  if (!out.enough) return out;
  out.smooth = *std::min_element(energy.begin(), energy.end()) <= 0.0;
  if (out.smooth) return out;
  out.unit_m2 = energy[0] / count[0];
  for (std::size_t c = 0; c < energy.size(); ++c)
    out.window.log_energy[c] = static_cast<float>(std::log(energy[c] / count[c] / out.unit_m2));
  out.noise_m2 = cells.noise_m2 / cells.known + rounding_variance_m2(cells.largest_m);
  out.window.noise = static_cast<float>(out.noise_m2 / out.unit_m2);
  out.window.nugget = static_cast<float>(cells.inverse_hits / cells.known);
  const double fill = std::min(1.0, std::sqrt(0.5 * count[0] / cells.known));
  out.window.fill = static_cast<float>(fill);
  out.window.cells = static_cast<float>(cells.known / fill);
  return out;
}

}  // namespace scree::fractal
