#pragma once
// How rough ground can be whose cells' heights bend no more than they do.

#include <array>
#include <vector>

#include "core/executor.hpp"
#include "core/grid.hpp"
#include "fractal/box_sum.hpp"
#include "fractal/cell_mean_law.hpp"
#include "mapping/ground_layers.hpp"

namespace scree::mapping {

/// A window of D may hold a car or a tree that is not here. Second differences of the heights around a cell, over one
/// cell and over four (sparse rings of a lidar have few of the former), bound what any law may say of it. Second
/// differences, because a slope is no roughness. Their rms is taken from the mean root of their sizes, as that of
/// normal ones is to theirs: an rms would hear of nothing but the one wall in the window, a geometric mean of no
/// boulder on a twentieth of the cells. Ground of a law whose points change by c over a cell bends by
///   E b² = ((4 − 4^h) l^2h change² + within·Σ w²/k) c² + Σ w² R
/// over l cells: h, change and within are the law's of cell means (fractal/cell_mean_law.hpp), w = 1, −2, 1, and a
/// height of few returns (k, at most kIndependentPlaces) is that of some places of its cell; R = noise of the mean.
class BendLimit {
 public:
  /// No law is believed beyond kTrust times what the bends say, where the centres of kBends or more lie within two lags
  /// along both axes. Of ground of the law 8 independent ones fall that low about once in 40 (mean roots spread by
  /// .42/√8 about the true one), the 40 of full windows hardly ever.
  static constexpr float kTrust = 2.0F, kBends = 8.0F;

  /// Row-parallel but for the box sums. No allocation when the shape stays. Cost: docs/mapping.md.
  void update(const GroundLayers& ground, Executor& executor);

  /// The largest change of points over a cell, by the lesser of the lags; where neither has enough bends, by those of
  /// the whole map; +inf where these are too few.
  float change_m(int row, int column, const fractal::CellMeanLaw::Values& of_cells) const;

 private:
  /// Over bends: √|b|, their number, Σ w² R, Σ w²/k.
  struct Sums {
    float roots = 0.0F, count = 0.0F, noise_m2 = 0.0F, places = 0.0F;
  };
  struct Lag {
    int cells = 0;                                   ///< 1 or 4
    fractal::BoxSum roots, count, noise_m2, places;  ///< of the bends centred on each cell
    Sums total;
    std::array<fractal::BoxSum*, 4> boxes() { return {&roots, &count, &noise_m2, &places}; }
  };
  static void load_row(const GroundLayers& ground, int row, Lag& lag);
  static void add_up(Lag& lag, int rows);
  static float change_m(const Lag& lag, const Sums& sums, const fractal::CellMeanLaw::Values& of_cells);

  std::array<Lag, 2> lags_;
  fractal::BoxScratch scratch_;
};

}  // namespace scree::mapping
