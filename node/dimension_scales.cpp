#include "node/dimension_scales.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "fractal/vecchia_neighbours.hpp"
#include "node/length_text.hpp"

namespace scree::node {
namespace {

using fractal::Interval;
using fractal::ScaleLaw;

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

/// What the estimate itself rests on. The likelihood's median point has half of all before it in the (random) order, so
/// its nearest ones fill a circle of twice as many mean cells.
Interval own_range(const fractal::DimensionEstimate& estimate) {
  if (std::isfinite(estimate.lag_min_m)) return {estimate.lag_min_m, estimate.lag_max_m};
  return {estimate.spacing_m, estimate.spacing_m * std::sqrt(2.0 * fractal::kVecchiaNeighbours / std::numbers::pi)};
}

/// The law's distances are those of the estimate's D only where the law has the same D.
bool same_dimension(const DimensionAnswer& answer) {
  const Interval& own = answer.estimate.interval95;
  const auto& law = answer.scales->best();
  if (!answer.scales->law_fits()) return false;
  if (law.dimension >= own.low && law.dimension <= own.high) return true;
  return !says_nothing(law) && law.interval95.low <= own.high && law.interval95.high >= own.low;
}

void set_range(DimensionAnswer& answer) {
  const auto& estimate = answer.estimate;
  answer.scale_range_m = {kUnknown, kUnknown};
  if (!std::isfinite(estimate.dimension)) return;
  if (answer.scales && same_dimension(answer)) {
    const auto& law = answer.scales->best();
    if (law.lag_max_m > law.lag_min_m) answer.scale_range_m = {law.lag_min_m, law.lag_max_m};
    return;  // or the noise hides the law at all distances
  }
  answer.scale_range_m = own_range(estimate);
  answer.flags.emplace_back("scale_range_short");
}

void flag_law(DimensionAnswer& answer) {
  if (!answer.scales) return;
  const ScaleLaw law = answer.scales->best().law;
  if (law == ScaleLaw::two_scales) answer.flags.emplace_back("crossover");
  if (law == ScaleLaw::plateau) answer.flags.emplace_back("plateau");
  if (law == ScaleLaw::power_and_noise) answer.flags.emplace_back("excess_noise");
  if (!answer.scales->law_fits()) answer.flags.emplace_back("no_law_fits");
}

/// What short distances say against longer ones: heights near each other that differ too little are interpolated or
/// filtered, heights that differ too much are rounded or noisy.
void judge_short_lags(DimensionAnswer& answer) {
  const auto& estimate = answer.estimate;
  const bool dependent = (estimate.flags & fractal::kScaleDependent) != 0;
  const bool disagree = answer.check && answer.agreement.comparable && !answer.agreement.agree;
  const bool excess = answer.scales && answer.scales->best().law == ScaleLaw::power_and_noise;
  // at the smooth end of the scale of D, below what all distances together say
  const bool bounded = (estimate.flags & fractal::kOpenBelow) != 0 && answer.scales &&
                       answer.scales->best().interval95.low > estimate.interval95.high;
  if (bounded || (dependent && estimate.dimension < estimate.coarse_dimension) ||
      (disagree && answer.agreement.difference < 0.0))
    answer.flags.emplace_back("smooth_short_lags");
  if (excess || (dependent && estimate.dimension > estimate.coarse_dimension))
    answer.flags.emplace_back("rough_short_lags");
}

}  // namespace

bool says_nothing(const fractal::ScaleLawFit& law) {
  return law.interval95.low <= 2.0 && law.interval95.high >= 3.0;
}

std::string crossover_text(const fractal::ScaleLawFit& law) {
  return std::isfinite(law.crossover_m) ? length_text(law.crossover_m) + " m" : "a distance that was not looked at";
}

void judge_scales(DimensionAnswer& answer) {
  flag_law(answer);
  set_range(answer);
  judge_short_lags(answer);
}

}  // namespace scree::node
