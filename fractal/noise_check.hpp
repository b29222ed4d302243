#pragma once
// Is the noise that an estimate was told the noise that the heights show?

#include "core/result.hpp"
#include "fractal/dimension_estimate.hpp"

namespace scree::fractal {

struct NoiseCheck {
  DimensionEstimate free;   ///< by the likelihood, with the noise estimated from the heights
  double chi_square = 0.0;  ///< −2 log likelihood with the noise told, less that with the estimated one: 1 degree
  bool too_large = false, too_small = false;  ///< beyond kNoiseChiSquare: the heights show less, more noise
};

/// Exceeded once in 1000 surveys whose noise was told right (χ², 1 degree of freedom; less where there is none).
inline constexpr double kNoiseChiSquare = 10.83;

/// `told`: estimate_dimension_vecchia(survey) with a known noise, 0 included. Heights that are not one fractal over
/// these distances look like a wrong noise too. Errors: those of the estimator with an unknown noise (kMinNoisePoints
/// places at least). Cost: some 15 µs a point.
Result<NoiseCheck> check_noise(SurveyPoints survey, const DimensionEstimate& told);

}  // namespace scree::fractal
