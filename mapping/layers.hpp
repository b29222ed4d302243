#pragma once
// Every layer of a snapshot from the rolling map.

#include <optional>

#include "core/executor.hpp"
#include "core/rolling_grid.hpp"
#include "fractal/dimension_map.hpp"
#include "fractal/reconstruction/conditional.hpp"
#include "mapping/cell_states.hpp"
#include "mapping/cost.hpp"
#include "mapping/ground_layers.hpp"
#include "mapping/map_cell.hpp"
#include "mapping/mapper.hpp"
#include "mapping/terrain_shape.hpp"
#include "mapping/window_law.hpp"

namespace scree::mapping {

/// Roughness, reconstruction, states, shape and cost, in this order. Computed once per frame: the window's law and the
/// reconstruction's warm start advance with frames, never with readers.
class Layers {
 public:
  explicit Layers(const MapConfig& config);
  /// Sets every grid of `out`. `now_ms`: see GroundLayers::unroll.
  void compute(const RollingGrid<MapCell>& map, std::uint32_t now_ms, Executor& executor, MapSnapshot& out);

 private:
  void estimate_roughness(const LatticeWindow& window, Executor& executor);
  const fractal::Reconstruction* reconstruct(const LatticeWindow& window, Executor& executor);
  void publish_row(int row, MapSnapshot& out) const;

  MapConfig config_;
  GroundLayers ground_;
  Grid<float> measured_slope_rad_;
  Grid<float> deviation_m_;        ///< of the heights from the footprint's plane
  Grid<float> place_variance_m2_;  ///< noise of a height plus that of its returns' places on the slope
  fractal::DimensionMapper dimension_mapper_;
  const fractal::DimensionMap* roughness_ = nullptr;  ///< the mapper's, of the last update
  WindowLaw window_law_;
  std::optional<fractal::FractalLaw> law_;  ///< of the window, followed over frames
  fractal::ConditionalReconstructor reconstructor_;
  fractal::Reconstruction filled_;
  CellStates states_;
  TerrainShape shape_;
};

}  // namespace scree::mapping
