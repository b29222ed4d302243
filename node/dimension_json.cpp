// The JSON document of `scree dimension`.

#include <cmath>
#include <nlohmann/json.hpp>

#include "node/dimension_report.hpp"

namespace scree::node {
namespace {

using fractal::DimensionEstimate;
using Json = nlohmann::ordered_json;

Json number(double value) {
  return std::isfinite(value) ? Json(value) : Json();
}

Json pair(double low, double high) {
  return Json::array({number(low), number(high)});
}

Json pair(const fractal::Interval& interval) {
  return pair(interval.low, interval.high);
}

Json check_json(const DimensionAnswer& answer) {
  const DimensionEstimate& check = *answer.check;
  return {{"method", check.method},
          {"dimension", number(check.dimension)},
          {"interval95", pair(check.interval95)},
          {"amplitude_m", number(check.amplitude_m)},
          {"difference", number(answer.agreement.difference)},
          {"allowed", number(answer.agreement.allowed)},
          {"agree", answer.agreement.comparable ? Json(answer.agreement.agree) : Json()}};
}

Json scales_json(const fractal::ScaleAnalysis& scales) {
  const fractal::ScaleLawFit& best = scales.best();
  Json json{{"law", fractal::scale_law_name(best.law)},
            {"dimension", number(best.dimension)},
            {"interval95", pair(best.interval95)},
            {"amplitude_m", number(best.amplitude_m)},
            {"range_m", pair(best.lag_min_m, best.lag_max_m)},
            {"chi_square", number(best.chi_square)},
            {"degrees_of_freedom", best.degrees_of_freedom},
            {"coarse_dimension", number(best.coarse_dimension)},
            {"crossover_m", number(best.crossover_m)},
            {"plateau_m", number(best.plateau_m)},
            {"excess_noise_sigma_m", number(best.noise_sigma_m)}};
  for (const auto& fit : scales.fits)
    json["criterion"][std::string(fractal::scale_law_name(fit.law))] = number(fit.criterion);
  return json;
}

Json anisotropy_json(const fractal::Anisotropy& found) {
  Json json{{"chi_square", number(found.chi_square)},
            {"p_value", number(found.p_value)},
            {"significant", found.significant},
            {"anisotropic", found.matters()},
            {"direction_rad", number(found.direction_rad)},
            {"strength", number(found.strength)},
            {"index_v", number(found.index_v)},
            {"index_v_null95", number(found.index_v_null95)},
            {"index_v_significant", found.v_significant}};
  for (const double hurst : found.hurst) json["directional_dimension"].push_back(number(3.0 - hurst));
  return json;
}

Json noise_check_json(const fractal::NoiseCheck& check) {
  return {{"chi_square", number(check.chi_square)},
          {"noise_sigma_m", number(check.free.noise_sigma_m)},
          {"dimension", number(check.free.dimension)},
          {"interval95", pair(check.free.interval95)}};
}

Json maps_json(const MapsSummary& summary) {
  return {{"cell_m", summary.cell_m},
          {"window_cells", summary.window_cells},
          {"rows", summary.rows},
          {"columns", summary.columns},
          {"known_cells", summary.known_cells},
          {"dimension_cells", summary.dimension_cells},
          {"median_dimension", number(summary.median_dimension)},
          {"too_little_data", summary.too_little_data},
          {"noise_limited", summary.noise_limited},
          {"at_bound", summary.at_bound},
          {"not_fractal", summary.not_fractal},
          {"anisotropic", summary.anisotropic}};
}

Json recording_json(const SurveyFrames& frames) {
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

}  // namespace

std::string dimension_json(const DimensionReport& report) {
  const DimensionAnswer& answer = report.answer;
  const DimensionEstimate& estimate = answer.estimate;
  Json json{
      {"dimension", number(estimate.dimension)},
      {"interval95", answer.has_interval ? pair(estimate.interval95) : Json()},
      {"sigma", number(estimate.sigma)},
      {"amplitude_m", number(estimate.amplitude_m)},
      {"method", estimate.method},
      {"points", estimate.points},
      {"scale_range_m", pair(answer.scale_range_m)},
      {"flags", all_flags(report)},
      {"points_found", report.input.found},
      {"points_skipped", report.input.skipped},
      {"duplicates", estimate.duplicates},
      {"spacing_m", estimate.spacing_m},
      {"coarse_dimension", number(estimate.coarse_dimension)},
      {"coarse_spacing_m", number(estimate.coarse_spacing_m)},
      {"noise_sigma_m", report.request.noise_auto ? estimate.noise_sigma_m : report.request.noise_sigma_m},
      {"noise_estimated", estimate.noise_estimated},
      {"noise_xy_sigma_m", report.request.noise_xy_sigma_m},
      {"effective_noise_sigma_m", answer.noise_sigma_m},
      {"relative_noise", number(estimate.relative_noise)},
  };
  if (answer.check) json["check"] = check_json(answer);
  if (answer.noise_check) json["noise_check"] = noise_check_json(*answer.noise_check);
  if (answer.scales) json["scales"] = scales_json(*answer.scales);
  if (report.anisotropy) json["anisotropy"] = anisotropy_json(*report.anisotropy);
  if (report.input.frames) json["recording"] = recording_json(*report.input.frames);
  if (report.maps) json["maps"] = maps_json(*report.maps);
  return json.dump(2) + "\n";
}

}  // namespace scree::node
