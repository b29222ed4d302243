#pragma once
// A snapshot's layers as float grids with names, for files and pictures.

#include <string>
#include <vector>

#include "core/grid.hpp"
#include "io/picture.hpp"
#include "mapping/snapshot.hpp"

namespace scree::node {

struct MapLayer {
  std::string name;    ///< the wire's, in lower case: "cost"
  std::string title;   ///< for people, with the unit
  Grid<float> values;  ///< NaN = unknown; cost 0 … 254; cell_state 0 … 4
  io::ColourScale scale;
};

/// cost, elevation, dimension, amplitude, cell_state, elevation_sigma, dimension_sigma, slope, step, hits; and where
/// the map has them cell_age and, a received one has not, elevation_mean, risk and dimension_flags: the bits of
/// fractal::DimensionFlag, NaN where there is no D. 0 hits are NaN where they cannot be known to be 0: in measured and
/// in never seen cells.
std::vector<MapLayer> map_layers(const mapping::MapSnapshot& map);

}  // namespace scree::node
