#pragma once
// Every layer of a snapshot from the rolling map.

#include <optional>

#include "core/executor.hpp"
#include "core/rolling_grid.hpp"
#include "mapping/cell_states.hpp"
#include "mapping/ground_layers.hpp"
#include "mapping/law_field.hpp"
#include "mapping/local_elevation.hpp"
#include "mapping/map_cell.hpp"
#include "mapping/mapper.hpp"
#include "mapping/risk.hpp"
#include "mapping/roughness.hpp"
#include "mapping/terrain_shape.hpp"
#include "mapping/window_law.hpp"

namespace scree::mapping {

/// Roughness, reconstruction, states, shape, risk and cost, in this order. Computed once per frame: the laws, the
/// reconstruction's warm start and what cells remember of having been lethal advance with frames, never with readers.
class Layers {
 public:
  explicit Layers(const MapConfig& config);
  /// Sets every grid of `out`. `now_ms`: see GroundLayers::unroll.
  /// The cells' memory of having been lethal is kept in `map`.
  void compute(RollingGrid<MapCell>& map, std::uint32_t now_ms, Executor& executor, StageClock& clock,
               MapSnapshot& out);

 private:
  void estimate_roughness(const LatticeWindow& window, Executor& executor);
  fractal::Reconstruction* reconstruct(const RollingGrid<MapCell>& map, Executor& executor);
  void judge_risk(const fractal::Reconstruction& filled, const Grid<CellState>& state, Executor& executor);
  void shape_outputs(MapSnapshot& out) const;
  void hand_over(fractal::Reconstruction* filled, MapSnapshot& out);
  float sigma_m(int row, int column, const fractal::Reconstruction* filled) const;
  void publish_row(int row, const fractal::Reconstruction* filled, RollingGrid<MapCell>& map, MapSnapshot& out);

  MapConfig config_;
  GroundLayers ground_;
  Grid<float> measured_slope_rad_;
  Grid<float> place_variance_m2_;  ///< noise of a height plus that of its returns' places on the slope
  Roughness roughness_;
  const RoughnessMap* rough_ = nullptr;  ///< of the last update
  WindowLaw window_law_;
  std::optional<fractal::FractalLaw> law_;  ///< of the window, followed over frames
  CellStates states_;
  const Grid<std::uint8_t>* closed_ = nullptr;  ///< measured cells and those between them
  LawField law_field_;
  LocalElevation elevation_;
  TerrainShape shape_;
  Grid<float> face_m2_;  ///< squared height of a face inside a cell
  FootprintRisk footprint_risk_;
  Risk risk_;
};

}  // namespace scree::mapping
