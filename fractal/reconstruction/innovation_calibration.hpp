#pragma once
// How wrong the predicted variances were where the ground was then measured.

#include "core/executor.hpp"
#include "core/grid.hpp"
#include "fractal/reconstruction/box_cascade.hpp"

namespace scree::fractal {

struct InnovationConfig {
  double window_cells = 8.0;    ///< sd of the window g over the ground, > 0
  double prior_cells = 10.0;    ///< n0: how many cells the word of the law is worth, > 0
  double memory_frames = 20.0;  ///< frames after which what was learned counts 1/e, > 0
  double limit = 9.0;           ///< of one e²/s², in units of max(q, 1); > 0
};

/// Errors of D and amplitude make the predicted variance wrong by a factor that varies slowly over the ground. Each
/// cell that is measured tells: e its height less what was predicted, s² = v + R with v the predicted variance
/// *without* this factor and R the datum's. So v ← q·v (residuals and draws times √q) with
///
///     q(x) = (n0 + Σ g·min(e²/s², limit)/κ) / (n0 + Σ g)
///
/// over all cells heard of, those of k frames ago times exp(−k/memory). Σ g is an effective number of cells: g is
/// scaled by Σg/Σg² (2 for a Gaussian of height 1), so that of dense data Σ g is about 4π·window²·density, and their
/// mean of e²/s² has the variance 2/Σ g. Errors of neighbours are taken as independent: of cells that enter shoulder to
/// shoulder q is less certain than Σ g says. The limit cuts one of 370 good cells and keeps a wild one from widening
/// the surroundings: alone it raises √q to at most 1.55. κ = E min(χ²₁, limit) = .995 takes back what the cut costs
/// good cells; because the limit follows q a law that is wrong by any factor is still found, in a few frames. Beliefs
/// belong to the ground: they stay with their cells while the window moves, and ground that enters starts from q = 1.
class InnovationCalibration {
 public:
  explicit InnovationCalibration(const InnovationConfig& config = {});

  /// One frame. `window` places the grid on the world lattice; it may move and change its shape, what lies in both the
  /// old and the new one is kept. `squared_ratio`: e²/s² of the cells that were measured, of the window's shape, NaN
  /// (or below 0) = none, ∞ allowed. Does not depend on the executor; no allocation while the shape stays. Cost:
  /// O(cells) whatever window_cells, some 0.4 ms at 200² on one core.
  void update(const LatticeWindow& window, const Grid<float>& squared_ratio, Executor& executor);

  /// q of every cell of the last window, > 0; before the first update() empty.
  const Grid<float>& factor() const { return factor_; }
  const LatticeWindow& window() const { return window_; }

 private:
  void follow(const LatticeWindow& window);
  void carry(const LatticeWindow& window, float entering, Grid<float>& cells);

  InnovationConfig config_;
  int radius_;
  float keep_, scale_, share_;
  LatticeWindow window_;
  Grid<float> sum_, count_, factor_, spare_;  ///< Σ of ratios and number of each cell's own, forgotten as time passes
  BoxCascade sums_, counts_;
};

}  // namespace scree::fractal
