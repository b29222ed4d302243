#include "node/dimension_methods.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "fractal/vecchia.hpp"

namespace scree::node {
namespace {

using fractal::Moment;
using fractal::ScaleLaw;
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

/// Scales where the law holds among those that were looked at, NaN where noise hides it on all of them; without an
/// analysis the lags of the estimate, or what the likelihood has seen: up to a quarter of the survey's side.
fractal::Interval scales_of(const DimensionAnswer& answer) {
  const auto& estimate = answer.estimate;
  if (answer.scales) {
    const auto& points = answer.scales->points;
    const double low = std::max(answer.scales->best().lag_min_m, std::exp(points.front().log_lag));
    const double high = std::min(answer.scales->best().lag_max_m, std::exp(points.back().log_lag));
    if (high > low && std::isfinite(estimate.dimension)) return {low, high};
    return {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::quiet_NaN()};
  }
  if (std::isfinite(estimate.lag_min_m)) return {estimate.lag_min_m, estimate.lag_max_m};
  return {estimate.spacing_m, estimate.spacing_m * std::sqrt(static_cast<double>(estimate.points)) / 4.0};
}

void look_at_scales(const SurveyPoints& survey, const DimensionRequest& request, Executor& executor,
                    DimensionAnswer& answer) {
  auto scales = fractal::analyse_scales(with_noise(survey, answer), {request.max_lag_m, request.seed}, executor);
  if (!scales) {  // too few points for more than one law
    answer.flags.emplace_back("scales_unknown");
    return;
  }
  const ScaleLaw law = scales->best().law;
  if (law == ScaleLaw::two_scales) answer.flags.emplace_back("crossover");
  if (law == ScaleLaw::plateau) answer.flags.emplace_back("plateau");
  if (law == ScaleLaw::power_and_noise) answer.flags.emplace_back("excess_noise");
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

Result<DimensionAnswer> by_vecchia(const SurveyPoints& survey) {
  auto estimate = fractal::estimate_dimension_vecchia(survey);
  if (!estimate) return estimate.error();
  DimensionAnswer answer;
  answer.estimate = *std::move(estimate);
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
  answer.noise_sigma_m = request.noise_sigma_m;
  answer.scale_range_m = {found->fit.lag_min_m, found->fit.lag_max_m};
  answer.plot_points = std::move(found->points);
  answer.plot_moment = options.moment;
  answer.flags.emplace_back("raw_heights");
  if (!answer.has_interval) answer.flags.emplace_back("no_interval");
  if (!(answer.estimate.dimension > 2.0 && answer.estimate.dimension < 3.0)) answer.flags.emplace_back("out_of_range");
  return answer;
}

/// What short distances say against longer ones: heights near each other that differ too little are interpolated or
/// filtered, heights that differ too much are rounded or noisy.
void judge_short_lags(DimensionAnswer& answer) {
  const auto& estimate = answer.estimate;
  const bool dependent = (estimate.flags & fractal::kScaleDependent) != 0;
  const bool disagree = answer.check && answer.agreement.comparable && !answer.agreement.agree;
  const bool excess = answer.scales && answer.scales->best().law == ScaleLaw::power_and_noise;
  if ((dependent && estimate.dimension < estimate.coarse_dimension) || (disagree && answer.agreement.difference < 0.0))
    answer.flags.emplace_back("smooth_short_lags");
  if (excess || (dependent && estimate.dimension > estimate.coarse_dimension))
    answer.flags.emplace_back("rough_short_lags");
}

Result<DimensionAnswer> by_law(const SurveyInput& input, const DimensionRequest& request, Executor& executor) {
  const SurveyPoints survey = points_of(input, request);
  auto answer = request.method == "vecchia"              ? by_vecchia(survey)
                : request.method == "structure-function" ? by_structure(survey, request, executor)
                                                         : by_choice(survey, request, executor);
  if (!answer) return answer.error();
  answer->noise_sigma_m = answer->estimate.noise_sigma_m;
  look_at_scales(survey, request, executor, *answer);
  answer->scale_range_m = scales_of(*answer);
  judge_short_lags(*answer);
  return answer;
}

/// Beside the estimator's flags what the input itself is suspected of.
void add_flags(const SurveyInput& input, DimensionAnswer& answer) {
  std::vector<std::string> flags;
  for (const auto name : fractal::flag_names(answer.estimate.flags))
    if (answer.has_interval || !name.starts_with("open_")) flags.emplace_back(name);
  constexpr double kRounding = 0.28;
  if (input.whole_metres && answer.noise_sigma_m < kRounding) flags.emplace_back("whole_metre_heights");
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
