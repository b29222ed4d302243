#pragma once
// The amplitude of ground whose D is known.

#include "core/result.hpp"
#include "fractal/dimension_estimate.hpp"

namespace scree::fractal {

/// rms height change over 1 m, in metres: the restricted likelihood of estimate_dimension_vecchia at the given D, 2.01
/// ≤ D ≤ 2.99 (clamped), plane profiled out, noise known (noise_unknown must not be set). Over the mean spacing it is
/// good to 1/√(2N); at 1 m the error of D is added. Errors: those of prepare_points; bad_data where the noise hides the
/// ground. Cost: as one pass of the estimator, 1 to 3 µs a point.
Result<double> estimate_amplitude(const SurveyPoints& survey, double dimension);

}  // namespace scree::fractal
