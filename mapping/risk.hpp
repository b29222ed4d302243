#pragma once
// How likely the vehicle comes to grief on a cell, from what the ground may look like.

#include <cstdint>
#include <vector>

#include "core/cell_state.hpp"
#include "core/executor.hpp"
#include "core/grid.hpp"
#include "mapping/footprint.hpp"
#include "mapping/vehicle.hpp"

namespace scree::mapping {

struct RiskConfig {
  double cell_m = 0.1;
  int headings = 8;
  VehicleConfig vehicle;
};

/// What the draws say of each cell that was asked for. Grids of the draws' shape; NaN elsewhere, and within a footprint
/// of the border, where the vehicle would stand on cells that the window does not hold.
struct Risk {
  Grid<float> worst;                ///< largest probability over the headings that a limit is violated, 0 … 1
  std::vector<Grid<float>> sector;  ///< of each heading
  Grid<float> tail;        ///< mean of the two largest loads (CVaR), at most 2, at the heading where it is largest
  Grid<float> on_unknown;  ///< 1 = at some heading a wheel stands on a cell that is unknown; else 0
};

/// What the draws' heights of cells do not show of the ground.
struct BesideHeights {
  const Grid<float>& relief_m2;  ///< variance of the ground within each cell
  const Grid<float>& face_m2;    ///< squared height of a face inside it; 0 = none
  /// A wheel violates on a possible drop that it may sink into: one that is part of a square as wide as lets it sink by
  /// the step, without a known cell in it (narrower, the wheel rolls over). never_seen and occluded cells are unknown.
  const Grid<CellState>& state;
};

/// The load of a draw at a heading is the largest share that the footprint takes of a limit: tangents of pitch and roll
/// of the plane under the wheels, what stands up under the belly over the clearance, the height change within a wheel's
/// radius of any wheel over the step. Heights of cells are means: under the belly each has kPeak standard deviations of
/// its relief on top, and a face inside it, in the square (a thin post may stand beside the mean: it is no less in the
/// way); a step grows likewise by kStepRelief of that variance and by faces. A load above 1 violates; above kMostLoad
/// none is told from another. Of K draws the loads' mean m and variance s² say
///   P = max( Φ((m − 1)/√((1 + 1/K)·s² + τ²)), share of the draws that violate ),
/// τ = kModelError for what a cell, a plane and four points make of a vehicle; in the share each draw counts by a
/// uniform error of the same standard deviation. The first knows more than multiples of 1/K, the second keeps one wild
/// draw from making the others' violation less likely. The tail is the mean of the two largest loads: for K = 8 the
/// worst quarter.
class FootprintRisk {
 public:
  static constexpr float kModelError = 0.1F;
  static constexpr float kMostLoad = 2.0F;
  // Both by argument, not by fit; with them the Brier scores of docs/map-accuracy.md were better than without.
  /// Largest of some sixteen places in a cell, and of the cell where it is largest under the belly.
  static constexpr float kPeak = 2.5F;
  /// Between wheels that stand anywhere and not in the middles of cells steps are larger by about this.
  static constexpr float kStepRelief = 2.0F;

  explicit FootprintRisk(const RiskConfig& config);

  /// draws_m: K ≥ 2 grids of one shape without NaN. Row-parallel, same bytes for any executor; no allocation when the
  /// shape stays. Cost: O(cells · K · headings · (wheels + belly)), vectorised over cells.
  void update(const std::vector<Grid<float>>& draws_m, const BesideHeights& inside, const Grid<std::uint8_t>& asked,
              Executor& executor, Risk& out);

 private:
  void note_unknown_row(const Grid<CellState>& state, int row);
  bool sinks(const Grid<CellState>& state, int row, int column) const;
  void prepare_row(const Grid<float>& draw_m, const BesideHeights& inside, int row, Grid<float>& step,
                   Grid<float>& tops_m) const;
  void risk_row(const std::vector<Grid<float>>& draws_m, const Grid<std::uint8_t>& asked, int row, Risk& out) const;
  void risk_block(const std::vector<Grid<float>>& draws_m, int row, int column, int count, Risk& out) const;

  RiskConfig config_;
  std::vector<Footprint> footprints_;
  int reach_;
  int gap_cells_;                    ///< the narrowest gap into which a wheel sinks by the step
  std::vector<CellIndex> disc_;      ///< the cells within a wheel's radius
  std::vector<Grid<float>> steps_;   ///< per draw: load of the step
  std::vector<Grid<float>> tops_m_;  ///< per draw: with relief and faces on top
  Grid<float> unknown_;              ///< 1 = nothing is known of the cell
};

}  // namespace scree::mapping
