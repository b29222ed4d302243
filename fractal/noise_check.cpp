#include "fractal/noise_check.hpp"

#include "fractal/vecchia.hpp"

namespace scree::fractal {

Result<NoiseCheck> check_noise(SurveyPoints survey, const DimensionEstimate& told) {
  survey.noise_unknown = true;
  survey.noise_sigma_m = 0.0;
  auto free = estimate_dimension_vecchia(survey);
  if (!free) return free.error();
  NoiseCheck check;
  check.free = *std::move(free);
  check.chi_square = told.minus_two_log - check.free.minus_two_log;
  const bool contradicts = check.chi_square > kNoiseChiSquare;
  check.too_large = contradicts && told.noise_sigma_m > check.free.noise_sigma_m;
  check.too_small = contradicts && told.noise_sigma_m < check.free.noise_sigma_m;
  return check;
}

}  // namespace scree::fractal
