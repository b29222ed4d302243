#pragma once
// How far the slope of a log–log line may be off: from the covariance of pair statistics, not from the scatter.

#include "core/executor.hpp"
#include "core/result.hpp"
#include "fractal/moment_dimension.hpp"

namespace scree::fractal {

/// Standard deviation of the D that an unweighted line through the annuli of `found.fit` has on fractional Brownian
/// ground of that D at these points: the covariance of the structure function's logarithms under the law
/// (lag_covariance.hpp), carried through the line. To first order |z − z'| and its square have the same. Tilt, noise
/// and the choice of the segment are not in it. Errors: those of lag_statistics. Cost: some tens of ms.
Result<double> moment_sigma(const SurveyPoints& survey, const MomentDimension& found, const MomentOptions& options,
                            Executor& executor);

}  // namespace scree::fractal
