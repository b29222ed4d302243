#pragma once
// D from a structure function that knows its noise: where horizontal noise is large, and to check the likelihood with.

#include "core/executor.hpp"
#include "core/result.hpp"
#include "fractal/dimension_estimate.hpp"

namespace scree::fractal {

struct StructureDimensionOptions {
  double max_lag_m = 0.0;  ///< longest distance used; 0: .225 √area, 2.5 spacings at least
  std::uint64_t seed = 1;  ///< which points stand for all at long distances of large surveys
};

/// Fits C·E|d + δ|^(2H) + 2s² (noise_sigma_m = s; δ, the displacement of one point against the other, from
/// noise_xy_sigma_m) to the logarithms of the structure function, weighted with their covariance under that law. The
/// least-squares plane is taken off, so that adding a plane changes nothing, and the model knows what that takes from
/// the ground. The interval is where the fit is worse by 3.84 than at its best; D is the
/// median of its likelihood, which differs from the most likely D only near 2 or 3. 2.005 ≤ D ≤ 2.99.
/// Errors, all bad_data: those of estimate_dimension_vecchia; fewer than four distances with 20 pairs or more. Noise
/// that hides the ground is a flag. Cost: 20 – 40 ms on one core, little of it depends on the number of points
/// (docs/fractal.md). Source: [AK96] section 2.4 for the statistics; the model is described in docs/fractal.md.
Result<DimensionEstimate> estimate_dimension_structure(const SurveyPoints& survey,
                                                       const StructureDimensionOptions& options, Executor& executor);

/// Two estimates of one survey by different methods.
struct Agreement {
  bool comparable = false;  ///< both have a D
  bool agree = false;  ///< the difference is within the intervals: √(a² + b²), a and b their halves that face it
  double difference = 0.0;  ///< D of the first less D of the second
  double allowed = 0.0;     ///< what |difference| may reach
};

/// Errors of two methods on the same points are correlated positively, so honest intervals pass more often than 95 %.
Agreement compare_estimates(const DimensionEstimate& first, const DimensionEstimate& second);

}  // namespace scree::fractal
