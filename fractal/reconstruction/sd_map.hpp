#pragma once
// The standard deviation of every cell from a handful of residual fields.

#include <vector>

#include "core/executor.hpp"
#include "core/grid.hpp"
#include "fractal/reconstruction/box_cascade.hpp"
#include "fractal/reconstruction/log_regression.hpp"
#include "fractal/reconstruction/sd_features.hpp"
#include "fractal/reconstruction/surface_problem.hpp"

namespace scree::fractal {

/// The mean square of K residual fields is the posterior variance times χ²(K)/K: with K = 8 its root errs by 28 % cell
/// by cell. But variances follow few rules: they grow with the distance d to the nearest datum and fall with the
/// density ρ of data around. So log v is regressed on 1, log d, log² d, log ρ, log ρ·log d over all unmeasured cells
/// (of a varying law log(v/σ²), σ the rms change over a cell, and also on H, H·log d, H·log ρ and |∇ ln σ²|² over a
/// spacing: on the slope from smooth to rough ground the surroundings decide), scaled to the mean of
/// the fields, and corrected by half (K = 8) of what the fields within two spacings of the data say beyond the model.
/// A measured cell has the closed form 1/(1/R + 1/v'), R the variance of its datum and v' the model's variance without
/// it: never above R. Errors of log sd: docs/reconstruction.md.
class SdMap {
 public:
  /// `mean_square_m2`: (1/K)·Σ of squares of K = `fields` ≥ 1 residual fields (their mean is known to be 0).
  /// `variance_m2`: of the measured cells, > 0; NaN elsewhere. `law`: per cell or one. `sd_m`: > 0 in every cell, m.
  /// No measured cell: NaN everywhere (the level is unknown). One: the law's own growth with distance, scaled. Fewer
  /// than 32 unmeasured cells: one v' in units of the law, found from all cells. Shapes equal, sides ≤
  /// DistanceTransform::kMaxSide. Does not depend on the executor. No allocation when shape and density stay. Cost:
  /// O(cells), about 1 ms at 256².
  void estimate(const Grid<float>& mean_square_m2, int fields, const Grid<float>& variance_m2, const LawMap& law,
                double cell_m, Executor& executor, Grid<float>& sd_m);

  /// After an estimate() with a measured cell: each cell's variance without a datum of its own, m².
  const Grid<float>& variance_alone_m2() const { return model_m2_; }
  /// After estimate(): the same sd with variance_alone_m2() times `factor` ≥ 1, for what the law does not know of.
  /// Measured cells stay below the sd of their data.
  void inflate(const Grid<float>& factor, const Grid<float>& variance_m2, Grid<float>& sd_m) const;

 private:
  void fit(const Grid<float>& mean_square_m2, const LawMap& law, double cell_m, Executor& executor);
  void fit_level(const Grid<float>& mean_square_m2, const Grid<float>& variance_m2, const LawMap& law, double cell_m);
  void predict(const Grid<float>& mean_square_m2, const LawMap& law, double cell_m, Executor& executor);
  void smooth_ratio(bool level_known);
  void correct(int fields, Executor& executor);

  SdFeatures features_;
  LogRegression regression_;
  LogRegression::Coefficients coefficients_ = {};
  Grid<float> model_m2_;
  std::vector<double> row_ratio_;
  double mean_ratio_ = 1.0;
  BoxCascade ratio_;  ///< of the fields to the model
};

}  // namespace scree::fractal
