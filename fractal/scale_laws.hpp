#pragma once
// Over which distances does a power law hold? Four laws for the structure function, and which of them the data want.

#include <limits>
#include <string_view>
#include <vector>

#include "core/executor.hpp"
#include "core/result.hpp"
#include "fractal/dimension_estimate.hpp"
#include "fractal/loglog_fit.hpp"
#include "fractal/structure_dimension.hpp"

namespace scree::fractal {

/// Mean-square height change over a distance d; the noise that is known of the sensor is part of each.
enum class ScaleLaw {
  power,            ///< C·d^(2H)
  power_and_noise,  ///< C·d^(2H) + 2s²: noise beyond what is known
  two_scales,       ///< C·d^(2H) + C₂·d^(2H₂), .1 < H < H₂: rough close by, smooth far off
  plateau,          ///< P·(1 − exp(−(d/r0)^(2H))): no growth beyond some r0
};
std::string_view scale_law_name(ScaleLaw law);  ///< "power", "power_and_noise", "two_scales", "plateau"

/// One law at its best. NaN: the law has no such thing.
struct ScaleLawFit {
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  ScaleLaw law = ScaleLaw::power;
  int parameters = 2;
  double chi_square = 0.0;     ///< of the fit, under the weights of the chosen law
  int degrees_of_freedom = 0;  ///< points − parameters
  /// chi_square + ln(points)·(2, 4, 4.5 for 2, 3, 4 parameters). Of the laws beside the plain power law the smallest is
  /// chosen; the power law itself may have a smaller one here and not be chosen, for it was rejected under its own
  /// weights and these are the winner's.
  double criterion = 0.0;
  double dimension = kNone;         ///< of the shortest scale: 3 − H
  Interval interval95;              ///< of it, under this law; 2 and 3 stand for an open side
  double amplitude_m = kNone;       ///< rms change over 1 m by the power law of the shortest scale
  double noise_sigma_m = kNone;     ///< power_and_noise: s, beyond the noise that is known
  double coarse_dimension = kNone;  ///< two_scales: 3 − H₂
  /// two_scales: where both terms are equal; plateau: r0. NaN where that lies beyond the distances looked at.
  double crossover_m = kNone;
  double plateau_m = kNone;  ///< plateau: rms change far beyond
  /// Where `dimension` holds: distances at which the local slope is nearer to H than to that of what comes before
  /// (noise, known or not) or after (the second scale, the plateau), within those that were looked at.
  double lag_min_m = kNone, lag_max_m = kNone;
};

struct ScaleAnalysis {
  /// Rms change by distance, natural logarithms of metres, all noise included; corrected for what taking off the
  /// least-squares plane takes from ground of the chosen law, so that a power law is a straight line.
  std::vector<LogLogPoint> points;
  std::vector<double> log_model;  ///< the chosen law at the points
  std::vector<ScaleLawFit> fits;  ///< one a law, in the order of ScaleLaw
  std::size_t chosen = 0;
  const ScaleLawFit& best() const { return fits[chosen]; }
  /// False: not even the chosen law describes the ground, its chi_square is beyond the 99.9 % point of chance.
  bool law_fits() const;
};

/// Fits the four laws by generalised least squares to the logarithms of the structure function of scattered points or
/// a raster (full or with gaps, points on a square lattice are recognised), and chooses by a criterion.
/// The plain power law is kept unless another is better under the power law's own covariance. Planes change nothing.
/// Errors, all bad_data: those of estimate_dimension_structure. Cost: 20 – 50 ms on one core for up to 65,536 points
/// (docs/fractal.md). Source: described in docs/fractal.md.
Result<ScaleAnalysis> analyse_scales(const SurveyPoints& survey, const StructureDimensionOptions& options,
                                     Executor& executor);

}  // namespace scree::fractal
