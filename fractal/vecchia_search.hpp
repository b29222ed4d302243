#pragma once
// Where to evaluate the likelihood: a first look on a part of the points, then lanes over H and nodes over τ about what
// it found.

#include <cstddef>

#include "fractal/vecchia_points.hpp"
#include "fractal/vecchia_profile.hpp"

namespace scree::fractal {

struct VecchiaOutcome {
  LaneProfile profile;
  HurstFit fit;
  double tau = 0.0;               ///< s²/C at the best H
  double minus_two_log = 0.0;     ///< there, on one scale whatever is known of the noise
  HurstFit coarse;                ///< of a random part
  std::size_t coarse_points = 0;  ///< behind it; all points where these are few
};

VecchiaOutcome search_likelihood(const VecchiaPoints& survey);

}  // namespace scree::fractal
