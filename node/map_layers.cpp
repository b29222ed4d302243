#include "node/map_layers.hpp"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace scree::node {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

template <class T, class F>
Grid<float> convert(const Grid<T>& from, const F& value) {
  Grid<float> to(from.rows(), from.columns());
  for (std::size_t i = 0; i < from.size(); ++i) to[i] = value(from[i]);
  return to;
}

float cost_value(std::uint8_t cost) {
  return cost == mapping::kCostUnknown ? kNaN : static_cast<float>(cost);
}

/// No cell is measured by 0 returns: a received map then holds the cell without its hits. Of a cell that was never seen
/// it may hold nothing at all.
Grid<float> known_hits(const mapping::MapSnapshot& map) {
  Grid<float> hits(map.hits.rows(), map.hits.columns());
  for (std::size_t i = 0; i < hits.size(); ++i)
    hits[i] = map.hits[i] == 0 && (map.state[i] == CellState::measured || map.state[i] == CellState::never_seen)
                  ? kNaN
                  : static_cast<float>(map.hits[i]);
  return hits;
}

Grid<float> known_flags(const mapping::MapSnapshot& map) {
  Grid<float> flags(map.dimension_flags.rows(), map.dimension_flags.columns());
  for (std::size_t i = 0; i < flags.size(); ++i)
    flags[i] = std::isnan(map.dimension[i]) ? kNaN : static_cast<float>(map.dimension_flags[i]);
  return flags;
}

}  // namespace

std::vector<MapLayer> map_layers(const mapping::MapSnapshot& map) {
  using io::ColourMap;
  const auto state = [](CellState s) { return static_cast<float>(s); };
  std::vector<MapLayer> layers{
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
      {"hits", "returns in the cell", known_hits(map), {ColourMap::viridis, 0.0, {}, false}},
  };
  if (!map.cell_age_s.empty())
    layers.push_back(
        {"cell_age", "time since the last return / s", map.cell_age_s, {ColourMap::viridis, 0.0, {}, false}});
  if (!map.dimension_flags.empty())
    layers.push_back(
        {"dimension_flags", "flags of D (bits)", known_flags(map), {ColourMap::viridis, 0.0, 31.0, false}});
  // what is not on the wire a received map does not have
  if (!map.elevation_mean_m.empty())
    layers.push_back(
        {"elevation_mean", "elevation, posterior mean / m", map.elevation_mean_m, {ColourMap::terrain, {}, {}, true}});
  if (!map.risk.empty())
    layers.push_back({"risk", "probability that a limit is violated", map.risk, {ColourMap::viridis, 0.0, 1.0, false}});
  return layers;
}

}  // namespace scree::node
