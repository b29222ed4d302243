#pragma once
// Over which distances does the D of an answer hold, and what do the distances say against it?

#include <string>

#include "fractal/scale_laws.hpp"
#include "node/dimension_methods.hpp"

namespace scree::node {

/// The law's interval of D is open on both sides: it says nothing of D.
bool says_nothing(const fractal::ScaleLawFit& law);

/// Sets scale_range_m from the estimate, the scales and the check, and adds the flags of all three:
///   crossover, plateau, excess_noise   the law that was chosen, if it is not one power law
///   no_law_fits   not even that one describes the ground
///   scale_range_short   the range is that of the points the estimate rests on: beyond it D is another, or unknown
///   smooth_short_lags, rough_short_lags   D grows, falls with distance
void judge_scales(DimensionAnswer& answer);

/// Where the second scale or the plateau begins: "405 m".
std::string crossover_text(const fractal::ScaleLawFit& law);

}  // namespace scree::node
