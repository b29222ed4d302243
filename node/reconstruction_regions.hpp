#pragma once
// Regions of influence: centres with laws of their own.

#include <string>
#include <vector>

#include "core/result.hpp"
#include "fractal/reconstruction/barycentre.hpp"
#include "node/reconstruction_grid.hpp"

namespace scree::node {

/// A table `x_m,y_m,dimension,amplitude_m` of centres on the map, as centres in the grid's frame. Where a line has
/// `auto` for D and amplitude they are estimated from the samples nearer to this centre than to any other (the
/// likelihood; D within 2.005 … 2.995). Errors: no_input, bad_data (file:line: what was expected), those of the
/// estimator, with the line of the region.
Result<std::vector<fractal::InfluenceCentre>> read_regions(const std::string& file, const PlacedSurvey& placed);

}  // namespace scree::node
