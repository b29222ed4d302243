#pragma once
// From a survey to D by the method that was asked for, or the one that suits the survey.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/executor.hpp"
#include "core/result.hpp"
#include "fractal/moment_dimension.hpp"
#include "fractal/noise_check.hpp"
#include "fractal/scale_laws.hpp"
#include "fractal/structure_dimension.hpp"
#include "node/survey_input.hpp"

namespace scree::node {

struct DimensionRequest {
  std::string method = "auto";  ///< one of dimension_methods()
  double noise_sigma_m = 0.0;
  bool noise_auto = false;  ///< noise_sigma_m is to be estimated
  double noise_xy_sigma_m = 0.0;
  fractal::Segmentation segmentation = fractal::Segmentation::least_squares;
  double max_lag_m = 0.0;  ///< 0 = chosen by the method
  std::uint64_t seed = 1;
};

struct DimensionAnswer {
  fractal::DimensionEstimate estimate;
  bool has_interval = true;
  bool raw_heights = false;  ///< noise and tilt are in D and not in its interval
  /// Of a height: given or estimated, with what horizontal noise adds on the slope; 0 where the method uses none.
  double noise_sigma_m = 0.0;
  fractal::Interval scale_range_m{0.0, 0.0};        ///< scales that D is for; NaN: hidden by noise
  std::optional<fractal::ScaleAnalysis> scales;     ///< where the points are enough for it
  std::optional<fractal::DimensionEstimate> check;  ///< auto: by the other method, where both apply
  fractal::Agreement agreement;                     ///< with it
  std::optional<fractal::NoiseCheck> noise_check;   ///< where a noise was told and the points could contradict it
  /// What the line was fitted to, for the methods that draw one.
  std::vector<fractal::LogLogPoint> plot_points;
  fractal::Moment plot_moment = fractal::Moment::second;
  std::vector<std::string> flags;  ///< of estimate and input, each once
};

std::vector<std::string> dimension_methods();

/// The estimate rests on a part of the input.
bool sampled(const SurveyInput& input, const DimensionAnswer& answer);

/// auto: Vecchia's likelihood, checked against the structure function; the structure function alone where horizontal
/// noise reaches .3 mean spacings, for which the likelihood has no model. Flags beside those of the estimators:
///   raw_heights, no_interval, out_of_range   of yokoya and pentland: noise and tilt are not taken off, too few points
///     for an interval; the line has D outside 2 ... 3, and D is unknown (NaN)
///   noise_too_large, noise_too_small   the heights contradict the noise that was told
///   methods_disagree   the two methods' intervals do not allow for the difference
///   crossover, plateau, excess_noise, no_law_fits, scale_range_short, smooth_short_lags, rough_short_lags   see
///     dimension_scales.hpp
///   scales_unknown   too few distances for that question
///   whole_metre_heights, cell_size_unknown, sampled   of the input
/// Errors: those of the estimators; usage where the noise is to be estimated by a method that cannot, or max_lag_m is
/// below the mean spacing.
Result<DimensionAnswer> find_dimension(const SurveyInput& input, const DimensionRequest& request, Executor& executor);

}  // namespace scree::node
