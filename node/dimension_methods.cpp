#include "node/dimension_methods.hpp"

#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <utility>

#include "fractal/vecchia.hpp"
#include "node/dimension_scales.hpp"

namespace scree::node {
namespace {

using fractal::Moment;
using fractal::SurveyPoints;

SurveyPoints points_of(const SurveyInput& input, const DimensionRequest& request) {
  return {.x_m = input.x_m,
          .y_m = input.y_m,
          .z_m = input.z_m,
          .noise_sigma_m = request.noise_sigma_m,
          .noise_xy_sigma_m = request.noise_xy_sigma_m,
          .height_resolution_m = input.height_resolution_m,
          .noise_unknown = request.noise_auto};
}

/// The survey for what needs a number: with the noise that the likelihood has found.
SurveyPoints with_noise(SurveyPoints survey, const DimensionAnswer& answer) {
  if (survey.noise_unknown) survey.noise_sigma_m = answer.estimate.noise_sigma_m;
  survey.noise_unknown = false;
  return survey;
}

Error no_noise_estimate(const std::string& found) {
  return {ErrorKind::usage,
          "--noise-sigma-m auto: expected a survey for the likelihood (--method auto or vecchia, "
          "horizontal noise below .3 mean spacings), found " +
              found};
}

void look_at_scales(const SurveyPoints& survey, const DimensionRequest& request, Executor& executor,
                    DimensionAnswer& answer) {
  auto scales = fractal::analyse_scales(with_noise(survey, answer), {request.max_lag_m, request.seed}, executor);
  if (!scales) {  // too few points for more than one law
    answer.flags.emplace_back("scales_unknown");
    return;
  }
  answer.scales = *std::move(scales);
}

Result<DimensionAnswer> by_structure(const SurveyPoints& survey, const DimensionRequest& request, Executor& executor) {
  if (request.noise_auto) return no_noise_estimate("the structure function");
  auto estimate = fractal::estimate_dimension_structure(survey, {request.max_lag_m, request.seed}, executor);
  if (!estimate) return estimate.error();
  DimensionAnswer answer;
  answer.estimate = *std::move(estimate);
  return answer;
}

/// Says nothing where the points are too few to tell a noise from.
void look_at_noise(const SurveyPoints& survey, DimensionAnswer& answer) {
  auto check = fractal::check_noise(survey, answer.estimate);
  if (!check) return;
  if (check->too_large) answer.flags.emplace_back("noise_too_large");
  if (check->too_small) answer.flags.emplace_back("noise_too_small");
  answer.noise_check = *std::move(check);
}

Result<DimensionAnswer> by_vecchia(const SurveyPoints& survey) {
  auto estimate = fractal::estimate_dimension_vecchia(survey);
  if (!estimate) return estimate.error();
  DimensionAnswer answer;
  answer.estimate = *std::move(estimate);
  if (survey.noise_sigma_m > 0.0) look_at_noise(survey, answer);
  return answer;
}

Result<DimensionAnswer> by_choice(const SurveyPoints& survey, const DimensionRequest& request, Executor& executor) {
  auto answer = by_vecchia(survey);
  if (!answer) return answer.error();
  if (answer->estimate.flags & fractal::kHorizontalNoise) return by_structure(survey, request, executor);
  const fractal::StructureDimensionOptions options{request.max_lag_m, request.seed};
  auto check = fractal::estimate_dimension_structure(with_noise(survey, *answer), options, executor);
  if (!check) return answer;  // too few points for a structure function
  answer->agreement = fractal::compare_estimates(answer->estimate, *check);
  if (answer->agreement.comparable && !answer->agreement.agree) answer->flags.emplace_back("methods_disagree");
  answer->check = *std::move(check);
  return answer;
}

/// A straight line can have any slope, a surface has not any D.
void keep_in_range(DimensionAnswer& answer) {
  auto& estimate = answer.estimate;
  if (!(estimate.dimension >= 2.0 && estimate.dimension <= 3.0)) {
    estimate.dimension = estimate.amplitude_m = estimate.sigma = std::numeric_limits<double>::quiet_NaN();
    answer.has_interval = false;
    answer.flags.emplace_back("out_of_range");
    return;
  }
  if (!answer.has_interval) answer.flags.emplace_back("no_interval");
  auto& interval = estimate.interval95;
  if (answer.has_interval && interval.low <= 2.0) interval.low = 2.0, estimate.flags |= fractal::kOpenBelow;
  if (answer.has_interval && interval.high >= 3.0) interval.high = 3.0, estimate.flags |= fractal::kOpenAbove;
}

Result<DimensionAnswer> by_moment(const SurveyInput& input, const DimensionRequest& request, Executor& executor) {
  if (request.noise_auto) return no_noise_estimate("--method " + request.method);
  fractal::MomentOptions options;
  options.moment = request.method == "yokoya" ? Moment::first_absolute : Moment::second;
  options.segmentation = request.segmentation;
  options.max_lag_m = request.max_lag_m;
  options.seed = request.seed;
  if (input.raster && input.raster->square()) {
    options.lattice_m = &input.raster->raster.height_m;
    options.lattice_cell_m = input.raster->cell_x_m;
  }
  auto found = fractal::estimate_dimension_moment(points_of(input, request), options, executor);
  if (!found) return found.error();
  DimensionAnswer answer;
  answer.estimate = std::move(found->estimate);
  answer.has_interval = std::isfinite(answer.estimate.sigma);
  answer.raw_heights = true;
  answer.scale_range_m = {found->fit.lag_min_m, found->fit.lag_max_m};
  answer.plot_points = std::move(found->points);
  answer.plot_moment = options.moment;
  answer.flags.emplace_back("raw_heights");
  keep_in_range(answer);
  return answer;
}

Result<DimensionAnswer> by_law(const SurveyInput& input, const DimensionRequest& request, Executor& executor) {
  const SurveyPoints survey = points_of(input, request);
  auto answer = request.method == "vecchia"              ? by_vecchia(survey)
                : request.method == "structure-function" ? by_structure(survey, request, executor)
                                                         : by_choice(survey, request, executor);
  if (!answer) return answer.error();
  if (const double spacing_m = answer->estimate.spacing_m; request.max_lag_m > 0.0 && request.max_lag_m < spacing_m)
    return Error{ErrorKind::usage,
                 fmt::format("--max-lag-m: expected at least the mean spacing of {:.3g} m, found {:g}", spacing_m,
                             request.max_lag_m)};
  answer->noise_sigma_m = answer->estimate.noise_sigma_m;
  look_at_scales(survey, request, executor, *answer);
  judge_scales(*answer);
  return answer;
}

/// Beside the estimator's flags what the input itself is suspected of.
void add_flags(const SurveyInput& input, DimensionAnswer& answer) {
  std::vector<std::string> flags;
  for (const auto name : fractal::flag_names(answer.estimate.flags))
    if (answer.has_interval || !name.starts_with("open_")) flags.emplace_back(name);
  constexpr double kRounding = 0.28;
  if (input.whole_metres && answer.noise_sigma_m < kRounding) flags.emplace_back("whole_metre_heights");
  if (input.raster && !input.raster->raster.placed) flags.emplace_back("cell_size_unknown");
  if (sampled(input, answer)) flags.emplace_back("sampled");
  flags.insert(flags.end(), answer.flags.begin(), answer.flags.end());
  answer.flags = std::move(flags);
}

}  // namespace

std::vector<std::string> dimension_methods() {
  return {"auto", "vecchia", "structure-function", "yokoya", "pentland"};
}

bool sampled(const SurveyInput& input, const DimensionAnswer& answer) {
  return answer.estimate.points + answer.estimate.duplicates < input.found;
}

Result<DimensionAnswer> find_dimension(const SurveyInput& input, const DimensionRequest& request, Executor& executor) {
  const bool moment = request.method == "yokoya" || request.method == "pentland";
  auto answer = moment ? by_moment(input, request, executor) : by_law(input, request, executor);
  if (!answer) return answer.error();
  add_flags(input, *answer);
  return answer;
}

}  // namespace scree::node
