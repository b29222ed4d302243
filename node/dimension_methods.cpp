#include "node/dimension_methods.hpp"

#include <algorithm>
#include <cmath>

#include "fractal/vecchia.hpp"

namespace scree::node {
namespace {

using fractal::DimensionEstimate;
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

/// Neighbours up to the coarse look's spacing carry nearly all that the likelihood knows of D.
Result<DimensionAnswer> by_vecchia(const SurveyPoints& survey) {
  auto estimate = fractal::estimate_dimension_vecchia(survey);
  if (!estimate) return estimate.error();
  DimensionAnswer answer;
  answer.estimate = *std::move(estimate);
  answer.noise_sigma_m = answer.estimate.noise_sigma_m;
  answer.scale_range_m = {answer.estimate.spacing_m,
                          std::max(answer.estimate.spacing_m, 2.0 * answer.estimate.coarse_spacing_m)};
  return answer;
}

Result<DimensionAnswer> by_moment(const SurveyInput& input, const DimensionRequest& request, Executor& executor) {
  if (request.noise_auto)
    return Error{ErrorKind::usage,
                 "--noise-sigma-m auto: expected --method auto or vecchia beside it, found --method " + request.method +
                     ", which takes no noise"};
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
  answer.has_interval = false;
  answer.noise_sigma_m = request.noise_sigma_m;
  answer.scale_range_m = {found->fit.lag_min_m, found->fit.lag_max_m};
  answer.plot_points = std::move(found->points);
  answer.plot_moment = options.moment;
  answer.flags.emplace_back("no_interval");
  const bool noise = request.noise_sigma_m > 0.0 || request.noise_xy_sigma_m > 0.0;
  if (noise) answer.flags.emplace_back("noise_ignored");
  if (!(answer.estimate.dimension > 2.0 && answer.estimate.dimension < 3.0)) answer.flags.emplace_back("out_of_range");
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
  return {"auto", "vecchia", "yokoya", "pentland"};
}

bool sampled(const SurveyInput& input, const DimensionAnswer& answer) {
  return answer.estimate.points + answer.estimate.duplicates < input.found;
}

Result<DimensionAnswer> find_dimension(const SurveyInput& input, const DimensionRequest& request, Executor& executor) {
  const bool moment = request.method == "yokoya" || request.method == "pentland";
  auto answer = moment ? by_moment(input, request, executor) : by_vecchia(points_of(input, request));
  if (!answer) return answer.error();
  add_flags(input, *answer);
  return answer;
}

}  // namespace scree::node
