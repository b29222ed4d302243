#pragma once
// Measured height changes and laws in one log–log plot, although the survey's plane was taken off the heights.

#include <vector>

#include "core/executor.hpp"
#include "core/result.hpp"
#include "fractal/dimension_estimate.hpp"
#include "fractal/loglog_fit.hpp"
#include "fractal/structure_dimension.hpp"

namespace scree::fractal {

/// Natural logarithms of metres.
struct LawPicture {
  /// Rms change by distance above the least-squares plane, noise included, each divided by the share that the plane
  /// leaves of ground of the first law: if that is the ground's, they lie on its power law (and noise).
  std::vector<LogLogPoint> points;
  /// What a second law would show in their place, divided by the same shares: it is straight only where the two agree
  /// on what the plane takes. Empty without one.
  std::vector<double> log_other;
};

/// `law` and `other` have a D. The lags are those of analyse_scales. Errors: those of estimate_dimension_structure.
/// Cost: of the lag statistics, below .1 s.
Result<LawPicture> law_picture(const SurveyPoints& survey, const StructureDimensionOptions& options,
                               const DimensionEstimate& law, const DimensionEstimate* other, Executor& executor);

}  // namespace scree::fractal
