#include "fractal/energy_covariance.hpp"

namespace scree::fractal {
namespace {

using PairSums = std::array<std::array<double, 3>, kSharedCounts>;

void add_pair(const IncrementKernel& kernel, const Increment& p, const Increment& q, PairSums& sums) {
  const IncrementPair pair(p, q);
  for (int oy = -kCorrelationReach; oy <= kCorrelationReach; ++oy)
    for (int ox = -kCorrelationReach; ox <= kCorrelationReach; ++ox) {
      const IncrementCovariance at = pair.covariance(kernel, ox, oy);
      auto& to = sums[static_cast<std::size_t>(pair.shared_cells(ox, oy))];
      to[0] += at.signal * at.signal;
      to[1] += at.signal * at.noise;
      to[2] += at.noise * at.noise;
    }
}

template <class Matrix>
void set(const PairSums& sums, double scale, int c, int d, SquareSums<Matrix>& out) {
  for (std::size_t m = 0; m < kSharedCounts; ++m) {
    out.signal2[m](c, d) = out.signal2[m](d, c) = scale * sums[m][0];
    out.signal_noise[m](c, d) = out.signal_noise[m](d, c) = scale * sums[m][1];
    out.noise2[m](c, d) = out.noise2[m](d, c) = scale * sums[m][2];
  }
}

void add(const PairSums& from, double sign, PairSums& to) {
  for (std::size_t m = 0; m < kSharedCounts; ++m)
    for (std::size_t i = 0; i < 3; ++i) to[m][i] += sign * from[m][i];
}

}  // namespace

EnergyCovariance energy_covariance(const IncrementKernel& kernel) {
  EnergyCovariance result;
  for (int c = 0; c < kClassCount; ++c)
    for (int d = 0; d <= c; ++d) {
      const auto first = kClasses[static_cast<std::size_t>(c)].increments(),
                 second = kClasses[static_cast<std::size_t>(d)].increments();
      PairSums sums{}, differences{};
      for (std::size_t i = 0; i < first.size(); ++i)
        for (std::size_t j = 0; j < second.size(); ++j) {
          PairSums pair{};
          add_pair(kernel, first[i], second[j], pair);
          add(pair, 1.0, sums);
          add(pair, i == j ? 1.0 : -1.0, differences);
        }
      set(sums, 2.0 / static_cast<double>(first.size() * second.size()), c, d, result.energies);
      if (c < kContrastClassCount) set(differences, 2.0, c, d, result.contrasts);
    }
  return result;
}

}  // namespace scree::fractal
