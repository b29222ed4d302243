#include "node/dimension_plot_data.hpp"

#include <cmath>
#include <utility>

#include "fractal/law_picture.hpp"
#include "fractal/moment_dimension.hpp"
#include "fractal/plane_fit.hpp"

namespace scree::node {
namespace {

using fractal::LogLogPoint;

/// Heights above the survey's least-squares plane.
std::vector<double> above_plane(const SurveyInput& input) {
  struct Point {
    double x, y, z;
  };
  const fractal::PlaneMoments moments(input.z_m.size(), [&input](std::size_t i) {
    return Point{input.x_m[i], input.y_m[i], input.z_m[i]};
  });
  const fractal::Plane plane = moments.plane();
  std::vector<double> heights(input.z_m.size());
  for (std::size_t i = 0; i < heights.size(); ++i)
    heights[i] = input.z_m[i] - moments.z - plane.slope_x * (input.x_m[i] - moments.x) -
                 plane.slope_y * (input.y_m[i] - moments.y);
  return heights;
}

/// Where there are too few for the structure function, or no law to compare them with.
Result<std::vector<LogLogPoint>> level_points(const DimensionReport& report, Executor& executor) {
  const std::vector<double> heights = above_plane(report.input);
  const fractal::SurveyPoints survey{.x_m = report.input.x_m, .y_m = report.input.y_m, .z_m = heights};
  fractal::MomentOptions options;
  options.moment = fractal::Moment::second;
  options.max_lag_m = report.request.max_lag_m;
  options.seed = report.request.seed;
  auto found = fractal::estimate_dimension_moment(survey, options, executor);
  if (!found) return found.error();
  return std::move(found->points);
}

bool disagree(const DimensionAnswer& answer) {
  return answer.check && answer.agreement.comparable && !answer.agreement.agree;
}

Result<fractal::LawPicture> picture_of(const DimensionReport& report, Executor& executor) {
  const SurveyInput& input = report.input;
  const DimensionRequest& request = report.request;
  const DimensionAnswer& answer = report.answer;
  const fractal::SurveyPoints survey{
      .x_m = input.x_m,
      .y_m = input.y_m,
      .z_m = input.z_m,
      .noise_sigma_m = request.noise_auto ? answer.estimate.noise_sigma_m : request.noise_sigma_m,
      .noise_xy_sigma_m = request.noise_xy_sigma_m,
      .height_resolution_m = input.height_resolution_m};
  return fractal::law_picture(survey, {request.max_lag_m, request.seed}, answer.estimate,
                              disagree(answer) ? &*answer.check : nullptr, executor);
}

/// For ground so smooth that the plane takes nearly all of what its law allows: the points as the structure function
/// has corrected them for its own law, others as they are.
DimensionPlotData smooth_picture(const DimensionAnswer& answer) {
  DimensionPlotData data;
  data.points = answer.scales->points;
  if (answer.scales->best().law != fractal::ScaleLaw::power) data.log_scales = answer.scales->log_model;
  if (!disagree(answer)) return data;
  for (const LogLogPoint& p : data.points)
    data.log_check.push_back(std::log(answer.check->amplitude_m) + (3.0 - answer.check->dimension) * p.log_lag);
  return data;
}

}  // namespace

Result<DimensionPlotData> dimension_plot_data(const DimensionReport& report, Executor& executor) {
  const DimensionAnswer& answer = report.answer;
  DimensionPlotData data;
  data.points = answer.plot_points;
  if (!data.points.empty()) return data;
  constexpr double kSmooth = 2.1;
  if (answer.scales && answer.estimate.dimension < kSmooth) return smooth_picture(answer);
  auto picture = picture_of(report, executor);
  if (!picture || !std::isfinite(answer.estimate.dimension)) {
    auto level = level_points(report, executor);
    if (!level) return level.error();
    data.points = *std::move(level);
    return data;
  }
  data.points = std::move(picture->points);
  data.log_check = std::move(picture->log_other);
  const auto& scales = answer.scales;
  if (!scales || scales->best().law == fractal::ScaleLaw::power || scales->points.size() != data.points.size())
    return data;
  // As far from the points as the analysis has it.
  for (std::size_t i = 0; i < data.points.size(); ++i)
    data.log_scales.push_back(data.points[i].log_change + scales->log_model[i] - scales->points[i].log_change);
  return data;
}

}  // namespace scree::node
