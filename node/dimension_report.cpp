#include "node/dimension_report.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <string_view>

namespace scree::node {
namespace {

using fractal::DimensionEstimate;
using Json = nlohmann::ordered_json;

Json number(double value) {
  return std::isfinite(value) ? Json(value) : Json();
}

Json interval(const DimensionAnswer& answer) {
  if (!answer.has_interval) return {};
  return Json::array({answer.estimate.interval95.low, answer.estimate.interval95.high});
}

Json counts(const SurveyFrames& frames) {
  const PixelCounts& c = frames.counts;
  return {{"frames", frames.frames},
          {"frames_skipped", frames.skipped_frames},
          {"pixels", c.pixels},
          {"no_return", c.no_return},
          {"untrusted_row", c.untrusted_row},
          {"out_of_limits", c.out_of_limits},
          {"self", c.self},
          {"speckle", c.speckle},
          {"mixed", c.mixed},
          {"ambiguous", c.ambiguous},
          {"sensor_noise_sigma_m", frames.noise_sigma_m},
          {"sensor_noise_xy_sigma_m", frames.noise_xy_sigma_m}};
}

Json maps(const MapsSummary& summary) {
  return {{"cell_m", summary.cell_m},
          {"window_cells", summary.window_cells},
          {"rows", summary.rows},
          {"columns", summary.columns},
          {"known_cells", summary.known_cells},
          {"dimension_cells", summary.dimension_cells},
          {"median_dimension", number(summary.median_dimension)},
          {"too_little_data", summary.too_little_data},
          {"noise_limited", summary.noise_limited},
          {"not_fractal", summary.not_fractal}};
}

std::string interval_text(const DimensionAnswer& answer) {
  const DimensionEstimate& estimate = answer.estimate;
  if (!answer.has_interval) return "no interval";
  const bool below = estimate.flags & fractal::kOpenBelow, above = estimate.flags & fractal::kOpenAbove;
  if (below && above) return "95 %: anything from 2 to 3";
  if (below) return fmt::format("95 %: at most {:.3f}", estimate.interval95.high);
  if (above) return fmt::format("95 %: at least {:.3f}", estimate.interval95.low);
  return fmt::format("95 %: {:.3f} to {:.3f}", estimate.interval95.low, estimate.interval95.high);
}

std::string noise_text(const DimensionReport& report) {
  const SurveyInput& input = report.input;
  const DimensionRequest& request = report.request;
  const DimensionAnswer& answer = report.answer;
  if (!answer.has_interval) return "noise and tilt not taken off";
  std::string text = fmt::format("noise {:g} m", request.noise_sigma_m);
  if (request.noise_auto) {
    text = fmt::format("noise {:.3g} m estimated", answer.estimate.noise_sigma_m);
  } else if (request.noise_sigma_m == 0.0 && request.noise_xy_sigma_m == 0.0) {
    text += " assumed (--noise-sigma-m)";
    if (input.frames)
      text = fmt::format("noise 0 m assumed (the sensor's: --noise-sigma-m {:.2g})", input.frames->noise_sigma_m);
  }
  if (request.noise_xy_sigma_m > 0.0)
    text +=
        fmt::format(" and {:g} m horizontal: {:.3g} m in all", request.noise_xy_sigma_m, answer.estimate.noise_sigma_m);
  return text;
}

/// Flags that the rest of the line has said already.
bool said(const std::string& flag) {
  constexpr std::array<std::string_view, 5> kSaid{"scale_dependent", "open_below", "open_above", "sampled",
                                                  "no_interval"};
  return std::find(kSaid.begin(), kSaid.end(), flag) != kSaid.end();
}

}  // namespace

std::string dimension_json(const DimensionReport& report) {
  const SurveyInput& input = report.input;
  const DimensionRequest& request = report.request;
  const DimensionAnswer& answer = report.answer;
  const DimensionEstimate& estimate = answer.estimate;
  Json json{
      {"dimension", number(estimate.dimension)},
      {"interval95", interval(answer)},
      {"sigma", number(estimate.sigma)},
      {"amplitude_m", number(estimate.amplitude_m)},
      {"method", estimate.method},
      {"points", estimate.points},
      {"scale_range_m", {answer.scale_range_m.low, answer.scale_range_m.high}},
      {"flags", answer.flags},
      {"points_found", input.found},
      {"points_skipped", input.skipped},
      {"duplicates", estimate.duplicates},
      {"spacing_m", estimate.spacing_m},
      {"coarse_dimension", number(estimate.coarse_dimension)},
      {"coarse_spacing_m", estimate.coarse_spacing_m},
      {"noise_sigma_m", request.noise_auto ? estimate.noise_sigma_m : request.noise_sigma_m},
      {"noise_estimated", estimate.noise_estimated},
      {"noise_xy_sigma_m", request.noise_xy_sigma_m},
      {"effective_noise_sigma_m", estimate.noise_sigma_m},
      {"relative_noise", number(estimate.relative_noise)},
  };
  if (input.frames) json["recording"] = counts(*input.frames);
  if (report.maps) json["maps"] = maps(*report.maps);
  return json.dump(2) + "\n";
}

std::string dimension_line(const DimensionReport& report) {
  const SurveyInput& input = report.input;
  const DimensionAnswer& answer = report.answer;
  const DimensionEstimate& estimate = answer.estimate;
  std::string line = std::isfinite(estimate.dimension)
                         ? fmt::format("D = {:.3f} ({}), amplitude {:.4g} m at 1 m", estimate.dimension,
                                       interval_text(answer), estimate.amplitude_m)
                         : fmt::format("D unknown ({}): the noise hides the ground", interval_text(answer));
  line += fmt::format("; {}, {} {}", estimate.method, estimate.points, input.cells() ? "cells" : "points");
  if (sampled(input, answer)) line += fmt::format(" chosen at random of {}", input.found);
  line += fmt::format(", {:.3g} to {:.3g} m", answer.scale_range_m.low, answer.scale_range_m.high);
  line += ", " + noise_text(report);
  if (estimate.flags & fractal::kScaleDependent)
    line += fmt::format("; not one law: D = {:.3f} at {:.3g} m spacing, {:.3f} at {:.3g} m", estimate.dimension,
                        estimate.spacing_m, estimate.coarse_dimension, estimate.coarse_spacing_m);
  for (const auto& flag : answer.flags)
    if (!said(flag)) line += "; " + flag;
  return line + "\n";
}

}  // namespace scree::node
