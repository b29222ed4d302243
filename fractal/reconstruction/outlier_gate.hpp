#pragma once
// Data that no ground of the given law explains.

#include <cstddef>
#include <cstdint>

#include "core/grid.hpp"
#include "fractal/reconstruction/cell_samples.hpp"
#include "fractal/reconstruction/surface_problem.hpp"

namespace scree::fractal {

/// Defaults: exact fBm loses no cell to them, and of 3 % outliers hardly one is left (docs/reconstruction.md).
struct OutlierOptions {
  int steps = 6;              ///< of reweighting
  double freedom = 4.0;       ///< ν of Student's t
  double ground_share = 1.0;  ///< of what data around leave open about a datum that counts as noise of the fit
  double limit = 4.0;         ///< standard deviations
};

struct OutlierReport {
  Grid<std::uint8_t> rejected;  ///< 1 = measured, and not ground
  std::size_t tested = 0;       ///< measured cells
  std::size_t count = 0;        ///< rejected ones
  std::size_t supported = 0;    ///< beyond the limit, but neighbours stand beside them
  int iterations = 0;           ///< multigrid cycles of all fits
};

/// The gate stands at the scale of the ground, not of the sensor: with only its own noise allowed a datum, the fit goes
/// through an outlier and nothing is left to see. So the blend is fitted with s² = R + p(D)·σ²·spacing^(2H) as the
/// variance of each datum: R its own, σ, H and D of the law there, spacing = 1/√(share of measured cells around), and
/// p(D)·σ²·spacing^(2H) the squared error with which the data around predict it. Each datum is weighted by
/// (ν + 1)/(ν + r²/s²), r its residual, `steps` times over [LLT89]. Rejected is |r| > limit·s,
/// unless two of the eight nearest data go with it: they differ from it by at most 2 standard deviations of the ground
/// over that distance, and by less than a third of what the fit does. So cliffs and rocks stay (all but 3–8 % of the
/// data within four cells of such an edge), and outliers that come in groups stay too. The law may vary. Cost: steps +
/// 1 warm solves; serial.
OutlierReport find_outliers(const CellSamples& samples, double cell_m, const LawMap& law,
                            const OutlierOptions& options = {});

/// The samples without the rejected cells; their `cells` counts what is left.
CellSamples without_outliers(const CellSamples& samples, const OutlierReport& report);

}  // namespace scree::fractal
