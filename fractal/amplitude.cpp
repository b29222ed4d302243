#include "fractal/amplitude.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "fractal/vecchia_likelihood.hpp"
#include "fractal/vecchia_points.hpp"

namespace scree::fractal {

Result<double> estimate_amplitude(const SurveyPoints& survey, double dimension) {
  const auto prepared = prepare_points(survey);
  if (!prepared) return prepared.error();
  constexpr double kStep = 1e-3;
  const double hurst = std::clamp(3.0 - dimension, kLeastHurst, kMostHurst);
  const double reach = 0.5 * kStep * (kHurstLanes - 1);
  const HurstLanes lanes{std::clamp(hurst - reach, kLeastHurst, kMostHurst - 2.0 * reach), kStep};
  const VecchiaLikelihood likelihood(*prepared);
  LaneProfile profile = likelihood.wide(lanes, likelihood.points());
  if (likelihood.noise() != VecchiaNoise::none) profile = likelihood.close(lanes, likelihood.points(), profile);
  const double c = std::exp(between_lanes(profile.log_c, (hurst - lanes.first) / kStep));
  if (prepared->noise_variance / c > 0.5 * kMostTau)
    return Error{ErrorKind::bad_data,
                 fmt::format("amplitude: expected ground that shows through a noise of {:g} m, found none",
                             survey.noise_sigma_m)};
  return std::sqrt(c) * prepared->height_m * std::pow(prepared->spacing_m, -hurst);
}

}  // namespace scree::fractal
