#include "node/map_layers.hpp"

#include <cstddef>
#include <cstdint>
#include <limits>

namespace scree::node {
namespace {

template <class T, class F>
Grid<float> convert(const Grid<T>& from, const F& value) {
  Grid<float> to(from.rows(), from.columns());
  for (std::size_t i = 0; i < from.size(); ++i) to[i] = value(from[i]);
  return to;
}

float cost_value(std::uint8_t cost) {
  return cost == mapping::kCostUnknown ? std::numeric_limits<float>::quiet_NaN() : static_cast<float>(cost);
}

}  // namespace

std::vector<MapLayer> map_layers(const mapping::MapSnapshot& map) {
  using io::ColourMap;
  const auto state = [](CellState s) { return static_cast<float>(s); };
  const auto hits = [](std::uint16_t h) { return static_cast<float>(h); };
  return {
      {"cost", "cost (0 free, 254 lethal)", convert(map.cost, cost_value), {ColourMap::cost, 0.0, 254.0, false}},
      {"elevation", "elevation / m", map.elevation_m, {ColourMap::terrain, {}, {}, true}},
      {"dimension", "fractal dimension D", map.dimension, {ColourMap::viridis, 2.0, 3.0, false}},
      {"amplitude", "rms height change at 1 m / m", map.amplitude_m, {ColourMap::viridis, 0.0, {}, false}},
      {"cell_state",
       "cell state (0 never seen … 4 measured)",
       convert(map.state, state),
       {ColourMap::viridis, 0.0, 4.0, false}},
      {"elevation_sigma",
       "elevation standard deviation / m",
       map.elevation_sigma_m,
       {ColourMap::viridis, 0.0, {}, false}},
      {"dimension_sigma", "standard deviation of D", map.dimension_sigma, {ColourMap::viridis, 0.0, {}, false}},
      {"slope", "slope / rad", map.slope_rad, {ColourMap::viridis, 0.0, {}, false}},
      {"step", "step / m", map.step_m, {ColourMap::viridis, 0.0, {}, false}},
      {"hits", "returns in the cell", convert(map.hits, hits), {ColourMap::viridis, 0.0, {}, false}},
  };
}

}  // namespace scree::node
