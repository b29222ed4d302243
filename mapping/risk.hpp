#pragma once
// How likely the vehicle comes to grief on a cell, from what the ground may look like.

#include <cstdint>
#include <vector>

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
  Grid<float> tail;  ///< load of the worst quarter or so of the draws (CVaR), at the heading where it is largest
};

/// What the cells' mean heights do not show of the ground inside them.
struct InsideCells {
  const Grid<float>& relief_m2;  ///< variance of the ground within each cell
  const Grid<float>& face_m2;    ///< squared height of a face inside it; 0 = none
};

/// The load of a draw at a heading is the largest share that the footprint takes of a limit: tangents of pitch and roll
/// of the plane under the wheels, what stands up under the belly over the clearance, the height change within a wheel's
/// radius of any wheel over the step. Heights of cells are means: under the belly each has kPeak standard deviations of
/// its relief on top, and a step grows by kStepRelief of that variance and by faces inside the cell, in the square. A
/// load above 1 violates. Of K draws the loads' mean m and variance s² say
///   P = Φ((m − 1)/√((1 + 1/K)·s² + τ²)),
/// τ = kModelError for what a cell, a plane and four points make of a vehicle: a share of K draws would know only
/// multiples of 1/K. The tail is the mean of the two largest loads: for K = 8 the worst quarter.
class FootprintRisk {
 public:
  static constexpr float kModelError = 0.1F;
  // Both by argument, not by fit; with them the Brier scores of docs/map-accuracy.md were better than without.
  /// Largest of some sixteen places in a cell, and of the cell where it is largest under the belly.
  static constexpr float kPeak = 2.5F;
  /// Between wheels that stand anywhere and not in the middles of cells steps are larger by about this.
  static constexpr float kStepRelief = 2.0F;

  explicit FootprintRisk(const RiskConfig& config);

  /// draws_m: K ≥ 2 grids of one shape without NaN. relief_m2: mean square of the step that a wheel meets inside a
  /// cell, beyond the cells' heights. Row-parallel, same bytes for any executor; no allocation when the shape stays.
  /// Cost: O(cells · K · headings · (wheels + belly)), vectorised over cells.
  void update(const std::vector<Grid<float>>& draws_m, const InsideCells& inside, const Grid<std::uint8_t>& asked,
              Executor& executor, Risk& out);

 private:
  void prepare_row(const Grid<float>& draw_m, const InsideCells& inside, int row, Grid<float>& step,
                   Grid<float>& tops_m) const;
  void risk_row(const std::vector<Grid<float>>& draws_m, const Grid<std::uint8_t>& asked, int row, Risk& out) const;
  void risk_block(const std::vector<Grid<float>>& draws_m, int row, int column, int count, Risk& out) const;

  RiskConfig config_;
  std::vector<Footprint> footprints_;
  int reach_;
  std::vector<CellIndex> disc_;      ///< the cells within a wheel's radius
  std::vector<Grid<float>> steps_;   ///< per draw: load of the step
  std::vector<Grid<float>> tops_m_;  ///< per draw: with the relief on top
};

}  // namespace scree::mapping
