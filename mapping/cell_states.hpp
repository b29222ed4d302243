#pragma once
// What the map may say of each cell, and its height where it may say one.

#include "core/cell_state.hpp"
#include "core/executor.hpp"
#include "core/grid.hpp"
#include "fractal/reconstruction/conditional.hpp"
#include "mapping/distance.hpp"
#include "mapping/ground_layers.hpp"

namespace scree::mapping {

struct StateConfig {
  double reach_cells = 6.0;  ///< reconstruct_reach_m in cells
  float drop_margin_m = 0.2F;
};

/// One cell's evidence. NaN, +inf (ceiling) and -inf (lip) mean that there is none.
struct CellEvidence {
  bool measured = false;
  bool between_measured = false;  ///< closed by the reach
  bool shadowed = false;
  float ceiling_m = 0.0F;
  float lip_m = 0.0F;
  float filled_mean_m = 0.0F;  ///< reconstruction's mean from the heights alone; NaN = there is no reconstruction
};

/// In this order: measured; possible_drop where the ceiling lies more than the margin below where the nearer ground
/// would have continued, or below the reconstructed mean; reconstructed between measured cells; occluded where rays
/// crossed without a return or a return shadows; never_seen.
CellState cell_state(const CellEvidence& evidence, float drop_margin_m);

/// Row-parallel classification of the window.
class CellStates {
 public:
  explicit CellStates(const StateConfig& config) : config_(config) {}
  /// Which cells lie between measured ones: 1 there and at measured cells. Before classify(). Valid until the next
  /// call.
  const Grid<std::uint8_t>& close(const GroundLayers& ground, Executor& executor);
  /// `filled` may be null: then nothing is reconstructed. elevation_m: fused height, or the first draw (never above the
  /// ceiling) where reconstructed, else NaN.
  void classify(const GroundLayers& ground, const fractal::Reconstruction* filled, Executor& executor,
                Grid<CellState>& state, Grid<float>& elevation_m);

 private:
  StateConfig config_;
  Closing closing_;
  Grid<std::uint8_t> closed_;
};

}  // namespace scree::mapping
