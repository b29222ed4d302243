#pragma once
// What pushes below the rays do to mean and spread.

#include "core/grid.hpp"
#include "fractal/reconstruction/box_cascade.hpp"

namespace scree::fractal {

/// Of K residual fields r_k (mean 0 known) and their pushes δ_k, metres: the mean moves by δ̄, whose noise is that of
/// the pushes alone, not of the fields; the sd of the map is scaled by the root of how the mean square about the mean
/// changes, (r + δ − δ̄)² + var(δ̄) against r², both over sd² and smoothed by a few cells before they are divided: their
/// noise is common, so the ratio keeps little of it.
class CeilingSums {
 public:
  void resize(int rows, int columns);
  void add(int row, int column, float residual_m, float delta_m);
  void add_row(int row, const float* residual_m, const float* delta_m);
  /// Cells of finite height_m, the measured ones, keep their sd. K ≥ 1 calls of add() for each cell before. No
  /// allocation when the shape stays.
  void finish(int fields, const Grid<float>& height_m, Grid<float>& mean_m, Grid<float>& sd_m);

  /// The mean alone.
  void move_mean(int fields, Grid<float>& mean_m) const;

 private:
  Grid<float> delta_, delta2_, square_, pushed_, pushed2_;  ///< Σ δ, δ², r², r + δ, (r + δ)²
  BoxCascade before_, after_;
};

}  // namespace scree::fractal
