// Every pair, one at a time, in double: what the fast routes are held against.

#include <cmath>

#include "fractal/annulus_rule.hpp"
#include "fractal/pair_routes.hpp"

namespace scree::fractal {

StructureFunction reference_pairs(const PointColumns& points, const Annuli& annuli, Executor&) {
  StructureFunction result{annuli, std::vector<PairSums>(static_cast<std::size_t>(annuli.count))};
  const AnnulusRule rule(annuli);
  for (std::size_t i = 0; i < points.size(); ++i)
    for (std::size_t j = i + 1; j < points.size(); ++j) {
      const float dx = points.x_m[j] - points.x_m[i], dy = points.y_m[j] - points.y_m[i];
      const int key = annulus_of(rule, annuli.spacing, dx, dy);
      if (key == annuli.count) continue;
      const double dz = double{points.z_m[j]} - points.z_m[i];
      auto& sums = result.sums[static_cast<std::size_t>(key)];
      sums.count += 1.0;
      sums.abs_m += std::abs(dz);
      sums.square_m2 += dz * dz;
      sums.log_m += std::log(std::hypot(double{dx}, double{dy}));
    }
  result.pairs_visited = points.size() * (points.size() - 1) / 2;
  return result;
}

}  // namespace scree::fractal
