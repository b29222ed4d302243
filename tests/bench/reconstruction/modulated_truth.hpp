#pragma once
// Ground whose D and amplitude vary from place to place, with a known local law.

#include <cstdint>

#include "core/grid.hpp"
#include "fractal/reconstruction/surface_problem.hpp"

namespace scree::bench {

/// Nodes U_i are exact fBm with H spaced by .05, made of one white noise; their *differences* are weighted edge by edge
/// with amplitude times hat weight of H, summed, and the part that is a gradient is integrated (a Poisson equation with
/// no flux through the border). So every zone is fBm of its law, and no amplitude multiplies a height. `law` varies;
/// its amplitudes are rms changes over a cell of size 1. Heights are float, their mean 0.
Grid<float> modulated_truth(const fractal::LawMap& law, std::uint64_t seed);

}  // namespace scree::bench
