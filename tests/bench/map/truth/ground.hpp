#pragma once
// Ground whose every property is known: exact fBm with half-buried rocks and a ditch, as fine nodes.

#include <cstdint>
#include <string>
#include <vector>

#include "fractal/surface.hpp"
#include "io/raster.hpp"

namespace scree::bench {

/// Distance of the nodes: a map cell of 0.1 m holds 5 × 5 of them, its border included.
inline constexpr double kNode_m = 0.025;

/// One scene. The law of its ground is told by the rms height change over kReliefLag_m, the scale of wheels and
/// footprint: with a fixed change over 1 m the smooth half of the dimensions would have no impassable ground and the
/// rough half no other.
struct GroundSpec {
  double dimension = 2.4;
  double relief_m = 0.03;
  std::uint64_t seed = 1;
  bool objects = true;  ///< rocks and the ditch
};
inline constexpr double kReliefLag_m = 0.3;

struct Rock {
  double x_m = 0.0, y_m = 0.0, radius_m = 0.1, height_m = 0.1;
};

struct Ground {
  fractal::FractalLaw law;
  io::Raster nodes;  ///< cell centres are the nodes, multiples of kNode_m
  std::vector<Rock> rocks;
  Grid<std::uint8_t> rock, ditch;  ///< which nodes they have moved
};

/// Nodes over x −7.5 … 14.5 m, y −11 … 11 m. 18 rocks: the upper halves of ellipsoids with radius 0.1 … 0.4 m and
/// height 0.1 … 0.5 m about the height of the ground at their centre, at least 0.6 m off the robot's way (y = 0, up to
/// x = 4.5 m). The ditch winds along y across x = 7.5 ± 0.7 m, 0.5 … 0.8 m wide, 0.5 m deep, its walls 0.1 m wide.
/// All of it depends on the seed alone. Fails where fbm_surface() does.
Result<Ground> make_ground(const GroundSpec& spec);

}  // namespace scree::bench
