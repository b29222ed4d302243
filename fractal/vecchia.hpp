#pragma once
// One D for a set of scattered points: restricted maximum likelihood under Vecchia's approximation.

#include "core/result.hpp"
#include "fractal/dimension_estimate.hpp"

namespace scree::fractal {

/// Fractional Brownian ground above any plane: each point, in random order, given its 13 nearest predecessors; the
/// plane and the amplitude are profiled out, the noise is known or (noise_unknown) profiled out too. The interval is
/// that of the profile likelihood. Adding a plane or scaling heights and noise together changes D by rounding only
/// (with noise_xy_sigma_m the slope of the plane counts, as it must). Independent of the order of the points. 2.005 ≤ D
/// ≤ 2.99. Errors, all bad_data: spans of different lengths, a value that is not finite, a negative noise, fewer than
/// kMinSurveyPoints places (kMinNoisePoints to estimate the noise), a noise both given and to be estimated, points on
/// one line, heights on one plane. Noise that hides the ground, so that the interval is open at both ends, is a flag,
/// with D and amplitude NaN. Cost: O(N log N) for the order,
/// then about 2 µs a point without and 5 µs with noise, 15 µs with an unknown one, on one core (docs/fractal.md).
/// Source: [V88], [SCW04] (REML); the lanes over H, the zoom and the search over τ are described in docs/fractal.md.
Result<DimensionEstimate> estimate_dimension_vecchia(const SurveyPoints& survey);

}  // namespace scree::fractal
