#include "mapping/ground_return.hpp"

#include <algorithm>
#include <cmath>

namespace scree::mapping {

namespace {

struct Surface {
  std::size_t begin = 0, end = 0;  ///< in the sorted heights
  std::size_t size() const { return end - begin; }
};

float mean_of(std::span<const float> values) {
  double sum = 0.0;
  for (const float v : values) sum += static_cast<double>(v);
  return static_cast<float>(sum / static_cast<double>(values.size()));
}

Surface surface_from(std::span<const float> sorted, std::size_t begin, float gap_m) {
  std::size_t end = begin + 1;
  while (end < sorted.size() && sorted[end] - sorted[end - 1] <= gap_m) ++end;
  return {begin, end};
}

bool agrees(std::span<const float> surface, float variance_m2, const StoredHeight& stored, float sigmas) {
  if (stored.variance_m2 < 0.0F) return false;
  const float difference_m = mean_of(surface) - stored.height_m;
  return difference_m * difference_m <= sigmas * sigmas * (variance_m2 + stored.variance_m2);
}

// The chosen surface and the end of what is below the overhang.
struct Choice {
  Surface chosen;
  Surface below_overhang;
};

Choice choose(std::span<const float> sorted, float gap_m, float variance_m2, const StoredHeight& stored,
              const GroundConfig& config) {
  const std::size_t n = sorted.size();
  Surface surface = surface_from(sorted, 0, gap_m);
  while (surface.size() * 10 < n && surface.end < n) surface = surface_from(sorted, surface.end, gap_m);

  Choice choice{surface, surface};
  bool known = agrees(sorted.subspan(surface.begin, surface.size()), variance_m2, stored, config.outlier_sigmas) &&
               surface.size() * 4 >= n;
  while (surface.end < n && sorted[surface.end] - sorted[surface.end - 1] < config.overhang_m) {
    surface = surface_from(sorted, surface.end, gap_m);
    choice.below_overhang.end = surface.end;
    if (known) continue;
    known = agrees(sorted.subspan(surface.begin, surface.size()), variance_m2, stored, config.outlier_sigmas) &&
            surface.size() * 4 >= n;
    if (known || surface.size() >= choice.chosen.size()) choice.chosen = surface;
  }
  return choice;
}

}  // namespace

GroundReturn ground_return(std::span<float> heights_m, std::span<const float> variances_m2, const StoredHeight& stored,
                           const GroundConfig& config) {
  const float variance_m2 = mean_of(variances_m2);
  const float gap_m = std::max(2.0F * config.cell_m, 6.0F * std::sqrt(variance_m2));
  Choice choice{{0, heights_m.size()}, {0, heights_m.size()}};
  const auto [lowest, highest] = std::minmax_element(heights_m.begin(), heights_m.end());
  GroundReturn out;
  out.bottom_m = *lowest;
  if (*highest - *lowest > gap_m) {
    std::sort(heights_m.begin(), heights_m.end());
    choice = choose(heights_m, gap_m, variance_m2, stored, config);
    out.bottom_m = heights_m[choice.below_overhang.begin];
  }
  out.height_m = mean_of(heights_m.subspan(choice.chosen.begin, choice.chosen.size()));
  out.hits = static_cast<int>(choice.chosen.size());
  out.others = static_cast<int>(heights_m.size()) - out.hits;
  out.noise_variance_m2 = variance_m2 / static_cast<float>(out.hits);
  double squares = 0.0;
  const auto relief = heights_m.subspan(choice.below_overhang.begin, choice.below_overhang.size());
  for (const float z : relief) squares += static_cast<double>((z - out.height_m) * (z - out.height_m));
  const auto n = static_cast<float>(relief.size());
  out.relief_m2 = std::max(0.0F, static_cast<float>(squares) / n - variance_m2 * (1.0F - 1.0F / n));
  return out;
}

}  // namespace scree::mapping
