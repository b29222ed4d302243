#pragma once
// What every method on cells asks of its input before it starts.

#include <string_view>

#include "core/result.hpp"
#include "fractal/reconstruction/cell_samples.hpp"

namespace scree::fractal {

/// Grids of one shape, `cells` of them measured, at least `at_least`; finite heights with positive variances; 2 < D <
/// 3, amplitude and cell finite and positive; draws ≥ 0. Errors name `method`, what it expects and what it found: usage
/// for the law and the request, bad_data for the samples.
Status check_surface(std::string_view method, const CellSamples& samples, const SurfaceRequest& request,
                     std::size_t at_least = 1);

/// Usage error where the law varies over the map.
Status check_one_law(std::string_view method, const LawMap& law);

}  // namespace scree::fractal
