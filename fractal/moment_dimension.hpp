#pragma once
// The paper's method from points to D: annuli chosen for the survey, pair moments by the cheapest route that gives
// them, the first linear part of the log–log plot.

#include <cstdint>
#include <vector>

#include "core/executor.hpp"
#include "core/grid.hpp"
#include "core/result.hpp"
#include "fractal/dimension_estimate.hpp"
#include "fractal/loglog_fit.hpp"
#include "fractal/structure_function.hpp"

namespace scree::fractal {

struct MomentOptions {
  Moment moment = Moment::first_absolute;
  Segmentation segmentation = Segmentation::least_squares;
  double max_lag_m = 0.0;   ///< centre of the last annulus; 0 = a quarter of the side of the survey's main box
  double tolerance = 0.05;  ///< of a linear part, nepers
  std::uint64_t seed = 1;   ///< of the thinning, where there is one
  /// The survey as a lattice of square cells (NaN = unknown), where it is one: the second moment then counts every pair
  /// of cells by Fourier transforms, also those that `survey` is only a part of.
  const Grid<float>* lattice_m = nullptr;
  double lattice_cell_m = 0.0;
};

struct MomentDimension {
  /// A line whose D lies outside [2, 3] is none of a surface: D, amplitude and sigma are NaN then, the interval is open
  /// on both sides, and `fit` holds what the line says. An end of the interval beyond 2 or 3 is open.
  DimensionEstimate estimate;
  LogLogDimension fit;
  std::vector<LogLogPoint> points;
  PairRoute route = PairRoute::near_pairs;
};

/// Yokoya's (first absolute moment) or Pentland's (second) D, as [AK96] section 2.4, with the mean log distances of the
/// annuli as abscissae. Points at one place count once, with their mean height. Annuli touch, a fourth of an octave
/// wide, from half a mean spacing (a lattice: one cell) on. Noise and tilt are part of the heights here: they are not
/// taken off, and `noise_sigma_m` is ignored. All pairs while there are at most 10^9 within reach, thinned above
/// (structure_function.hpp). The interval is D ± 1.96 of the standard deviation that fractional Brownian ground would
/// give (moment_interval.hpp): noise, tilt and the choice of the linear part are not in it, nor is what smooth ground
/// (D < 2.2) adds by its longest waves. Too few points for it: open on both sides, sigma NaN. Errors: those of
/// estimate_dimension_vecchia (what has no D); bad_data where fewer than five annuli
/// hold enough pairs or no three in a row lie on a line; usage (a lag that is not positive). Deterministic.
Result<MomentDimension> estimate_dimension_moment(const SurveyPoints& survey, const MomentOptions& options,
                                                  Executor& executor);

}  // namespace scree::fractal
