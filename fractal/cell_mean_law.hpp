#pragma once
// The law of a map's cells, which hold means over their area, from the law of the ground's points.

#include <array>

namespace scree::fractal {

/// Means over cells are smoother than points: of an fBm with squared change C over one cell, cells r apart differ by
/// C·(γ̄(r) − γ̄(0)) in the mean square (support.hpp), which for D = 2.8 is a quarter of C over one cell and nearly C
/// less a constant far away. No power law has that curve; the one given here agrees over kNear = 1 cell and kFar = 6
/// cells, which is as far as a datum stands from most gaps, and errs by at most 8 % of an rms change between and by 20
/// % at 16 cells, D = 2.8 (cell_mean_law_test.cpp).
class CellMeanLaw {
 public:
  static constexpr int kNear = 1, kFar = 6;
  /// Of a point law with 0.05 ≤ H ≤ 0.95: exponent of the cells' law, its rms change over a cell over that of points,
  /// and the variance of points within a cell over C.
  struct Values {
    float hurst, change, within;
  };
  static const CellMeanLaw& instance();
  /// Linear between nodes 0.025 apart; clamped.
  Values at(float hurst) const;
  /// What the table holds.
  static Values exact(double hurst);

 private:
  CellMeanLaw();
  static constexpr int kNodes = 37;
  std::array<Values, kNodes> nodes_;
};

}  // namespace scree::fractal
