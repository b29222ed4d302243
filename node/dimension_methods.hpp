#pragma once
// From a survey to D by the method that was asked for, or the one that suits the survey.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/executor.hpp"
#include "core/result.hpp"
#include "fractal/moment_dimension.hpp"
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
  double noise_sigma_m = 0.0;                 ///< of a height: given or estimated, with what horizontal noise adds
  fractal::Interval scale_range_m{0.0, 0.0};  ///< scales that D was estimated on
  std::optional<fractal::DimensionEstimate> check;  ///< by the other method, where both apply
  /// What the line was fitted to, for methods that fit one.
  std::vector<fractal::LogLogPoint> plot_points;
  fractal::Moment plot_moment = fractal::Moment::second;
  std::vector<std::string> flags;  ///< of estimate and input, each once
};

std::vector<std::string> dimension_methods();

/// The estimate rests on a part of the input.
bool sampled(const SurveyInput& input, const DimensionAnswer& answer);

/// auto: Vecchia's likelihood, which is as good as any up to horizontal noise of .3 mean spacings.
/// Errors: those of the estimators.
Result<DimensionAnswer> find_dimension(const SurveyInput& input, const DimensionRequest& request, Executor& executor);

}  // namespace scree::node
