#pragma once
// Data and prior of one window as linear systems: one for the mean, one for each residual field.

#include <algorithm>
#include <array>
#include <vector>

#include "fractal/reconstruction/blend_solver.hpp"
#include "fractal/reconstruction/surface_problem.hpp"
#include "fractal/reconstruction/varying_prior.hpp"

namespace scree::fractal {

/// Heights enter and leave in metres; inside they are in units of the rms change over one cell (of a varying law: of
/// its middle), less the weighted mean of the data. No allocation when the shape is unchanged.
class Conditioning {
 public:
  /// Grids of one shape, NaN = unmeasured, variance_m2 > 0 where measured (below 1e-6 of the squared change over a cell
  /// it counts as that, of a varying law roughly: float solves keep six digits). D is clamped to [2.05, 2.95]. `min`:
  /// of the grids on the world lattice. False without a measured cell: nothing can be solved for then.
  bool load(const Grid<float>& height_m, const Grid<float>& variance_m2, const LawMap& law, CellIndex min,
            double cell_m);

  const MultigridShape& shape() const { return shape_; }
  const BlendOperator& matrix() const { return matrix_; }
  const BlendField& prior() const { return prior_; }
  const PaddedField& precisions() const { return precision_; }
  /// Takes over the edges of `prior`: what is solved for from now on may break there.
  void set_edges(const BlendField& prior);
  double unit_m() const { return unit_m_; }
  double level_m() const { return level_m_; }
  double dimension() const { return dimension_; }
  /// c, > 0 where measured.
  const float* precision(int row) const { return precision_.row(row); }
  /// The smoother the ground, the more of the error is in waves that r·z hardly sees: at most .02 where any D < 2.3. A
  /// residual field without a last solution is solved for more closely: what its error does to the variance has a sign.
  double tolerance(double wanted) const { return smoothest_ < 2.3 ? std::min(0.02, wanted) : wanted; }
  double cold_tolerance(double wanted) const {
    return std::min(smoothest_ < 2.35 ? 0.005 : smoothest_ < 2.45 ? 0.01 : 0.02, wanted);
  }
  /// Of the data, 1/√(share of measured cells).
  double spacing_cells() const { return spacing_; }

  /// A·x = b for the mean, in units less the level.
  void mean_problem(const Grid<float>& height_m, PaddedField& b) const;
  /// u: an unconditional field in units; its weighted mean is taken off. b holds standard normals where measured,
  /// anything finite elsewhere, and becomes c·u + √c·n.
  void residual_problem(PaddedField& u, PaddedField& b) const;

 private:
  void set_precision(const Grid<float>& height_m, const Grid<float>& variance_m2, float base_m);

  MultigridShape shape_{4, 4};
  BlendOperator matrix_;
  BlendField prior_;
  VaryingPrior varying_prior_;
  PaddedField precision_, root_;             ///< c, √c
  std::array<std::vector<float>, 3> lines_;  ///< work space of set_precision
  double weight_ = 1.0;                      ///< sum of c
  double unit_m_ = 1.0, level_m_ = 0.0, dimension_ = 2.5, smoothest_ = 2.5, spacing_ = 1.0;
};

}  // namespace scree::fractal
