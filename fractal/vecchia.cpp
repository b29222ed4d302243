#include "fractal/vecchia.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "fractal/vecchia_likelihood.hpp"
#include "fractal/vecchia_points.hpp"
#include "fractal/vecchia_search.hpp"

namespace scree::fractal {
namespace {

DimensionEstimate describe(const VecchiaOutcome& outcome, const VecchiaPoints& survey) {
  const HurstFit& fit = outcome.fit;
  DimensionEstimate out;
  out.dimension = 3.0 - fit.hurst;
  out.sigma = fit.sigma;
  out.minus_two_log = outcome.minus_two_log;
  out.interval95 = {fit.high_open ? 2.0 : 3.0 - fit.high, fit.low_open ? 3.0 : 3.0 - fit.low};
  if (fit.high_open) out.flags |= kOpenBelow;
  if (fit.low_open) out.flags |= kOpenAbove;
  const double c = std::exp(between_lanes(outcome.profile.log_c, fit.lane));
  out.amplitude_m = std::sqrt(c) * survey.height_m * std::pow(survey.spacing_m, -fit.hurst);
  out.relative_noise = survey.noise_unknown ? outcome.tau : survey.noise_variance / c;
  out.noise_sigma_m = std::sqrt(survey.noise_unknown ? outcome.tau * c : survey.noise_variance) * survey.height_m;
  out.noise_estimated = survey.noise_unknown;
  if (out.relative_noise > 1.0) out.flags |= kNoiseHides;
  const std::size_t points = survey.points.size();
  if (outcome.coarse_points == points) return out;
  out.coarse_dimension = 3.0 - outcome.coarse.hurst;
  out.coarse_spacing_m =
      survey.spacing_m * std::sqrt(static_cast<double>(points) / static_cast<double>(outcome.coarse_points));
  constexpr double kDeviations = 3.3;
  if (std::abs(out.dimension - out.coarse_dimension) > kDeviations * std::hypot(outcome.coarse.sigma, fit.sigma))
    out.flags |= kScaleDependent;
  return out;
}

}  // namespace

Result<DimensionEstimate> estimate_dimension_vecchia(const SurveyPoints& survey) {
  const auto prepared = prepare_points(survey);
  if (!prepared) return prepared.error();
  DimensionEstimate out = describe(search_likelihood(*prepared), *prepared);
  const bool both_open = (out.flags & kOpenBelow) && (out.flags & kOpenAbove);
  if (both_open || out.relative_noise > 0.5 * kMostTau) {  // no H is ruled out, or amplitude 0 is as likely as any
    out.dimension = out.sigma = out.amplitude_m = std::numeric_limits<double>::quiet_NaN();
    out.interval95 = {};
    out.flags |= kOpenBelow | kOpenAbove;
    if (out.relative_noise > 0.0) out.flags |= kNoiseHides;
  }
  out.method = "vecchia";
  out.points = prepared->points.size();
  out.duplicates = prepared->duplicates;
  if (out.duplicates > 0) out.flags |= kDuplicatesMerged;
  out.spacing_m = prepared->spacing_m;
  constexpr double kWideNoise = 0.3;
  if (survey.noise_xy_sigma_m >= kWideNoise * out.spacing_m) out.flags |= kHorizontalNoise;
  return out;
}

}  // namespace scree::fractal
