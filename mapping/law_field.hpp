#pragma once
// The law of the ground in every cell, for the reconstruction: from estimates that are noisy and have holes.

#include "core/executor.hpp"
#include "core/grid.hpp"
#include "fractal/reconstruction/box_cascade.hpp"
#include "fractal/reconstruction/surface_problem.hpp"
#include "mapping/bend_limit.hpp"
#include "mapping/ground_layers.hpp"
#include "mapping/roughness.hpp"

namespace scree::mapping {

/// D and log of the rms change over one cell, averaged over a few cells with weights 1/sigma_D² (a tenth of it where
/// the estimate is flagged: limited by noise, at its bound, or no single power law) and, with the weight of one cell of
/// middling certainty, the law of the window; then followed over frames by a fifth of the way: the reconstruction's
/// warm start lives on laws that move little. Change over one cell and not amplitude at 1 m, because the errors of the
/// latter and of D are nearly one (docs/reconstruction.md).
class LawField {
 public:
  explicit LawField(double cell_m) : cell_m_(cell_m) {}

  /// `roughness` and `window_law` (of the middle of the map) are laws of the ground's points; none is believed beyond
  /// what the cells' heights around bear out (bend_limit.hpp).
  /// Row-parallel but for the box sums. No allocation when the shape stays.
  void update(const LatticeWindow& window, const RoughnessMap& roughness, const fractal::FractalLaw& window_law,
              const GroundLayers& ground, Executor& executor);

  /// A law for every cell of the window of the last update: of the means over cells, which are what the map's heights
  /// are (fractal/cell_mean_law.hpp).
  const fractal::LawMap& law() const { return law_; }
  /// Variance of the ground's points within each cell by its law.
  const Grid<float>& relief_m2() const { return relief_m2_; }
  /// Mean square of what a scanner does not see of a cell: it meets what stands out, and the mean of what it meets lies
  /// above the cell's by up to the relief, the more the rougher the ground: (kHidden·(1 − H))² of the relief.
  /// Measured: docs/mapping.md.
  const Grid<float>& hidden_m2() const { return hidden_m2_; }
  static constexpr float kHidden = 1.1F;

 private:
  fractal::FractalLaw of_cells(const fractal::FractalLaw& points) const;
  void follow_window(const LatticeWindow& window);
  void load_row(const RoughnessMap& roughness, int row);
  void follow_row(const fractal::FractalLaw& window_law, int row);
  void write_row(int row);

  double cell_m_;
  LatticeWindow window_;
  fractal::BoxCascade weight_, dimension_, log_change_;
  BendLimit limit_;
  Grid<float> followed_dimension_, followed_log_change_;  ///< NaN = not yet
  fractal::LawMap law_;
  Grid<float> relief_m2_, hidden_m2_;
};

}  // namespace scree::mapping
