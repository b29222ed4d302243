// scree dimension: D of points or of a DEM.

#include <CLI/CLI.hpp>
#include <array>
#include <cmath>
#include <cstdio>
#include <fmt/format.h>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "fractal/vecchia.hpp"
#include "node/commands/command_line.hpp"
#include "node/survey_input.hpp"

namespace scree::node {
namespace {

using fractal::DimensionEstimate;
using fractal::SurveyPoints;

struct DimensionOptions {
  std::string input;
  std::string method = "auto";
  double noise_sigma_m = 0.0;
  double noise_xy_sigma_m = 0.0;
  SurveyReading reading;
  bool json = false;
};

/// The estimators by name. `auto` is decided in estimate().
struct Method {
  const char* name;
  Result<DimensionEstimate> (*estimate)(const SurveyPoints&);
};
constexpr std::array<Method, 1> kMethods{{{"vecchia", fractal::estimate_dimension_vecchia}}};

std::vector<std::string> method_names() {
  std::vector<std::string> names{"auto"};
  for (const auto& method : kMethods) names.emplace_back(method.name);
  return names;
}

Result<DimensionEstimate> estimate(const std::string& name, const SurveyPoints& survey) {
  for (const auto& method : kMethods)
    if (name == method.name) return method.estimate(survey);
  return fractal::estimate_dimension_vecchia(survey);  // auto: nothing measured better from 20 points up
}

/// Beside the estimator's flags what the input itself is suspected of.
std::vector<std::string> all_flags(const DimensionEstimate& estimate, const SurveyInput& input) {
  std::vector<std::string> flags;
  for (const auto name : fractal::flag_names(estimate.flags)) flags.emplace_back(name);
  constexpr double kRounding = 0.28;
  if (input.whole_metres && estimate.noise_sigma_m < kRounding) flags.emplace_back("whole_metre_heights");
  if (input.found > input.x_m.size()) flags.emplace_back("sampled");
  return flags;
}

nlohmann::ordered_json number(double value) {
  return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json();
}

std::string as_json(const DimensionEstimate& estimate, const SurveyInput& input, const DimensionOptions& options) {
  const nlohmann::ordered_json json{
      {"dimension", number(estimate.dimension)},
      {"interval95", {estimate.interval95.low, estimate.interval95.high}},
      {"sigma", number(estimate.sigma)},
      {"amplitude_m", number(estimate.amplitude_m)},
      {"method", estimate.method},
      {"points", estimate.points},
      {"points_found", input.found},
      {"points_skipped", input.skipped},
      {"duplicates", estimate.duplicates},
      {"spacing_m", estimate.spacing_m},
      {"coarse_dimension", number(estimate.coarse_dimension)},
      {"coarse_spacing_m", estimate.coarse_spacing_m},
      {"noise_sigma_m", options.noise_sigma_m},
      {"noise_xy_sigma_m", options.noise_xy_sigma_m},
      {"effective_noise_sigma_m", estimate.noise_sigma_m},
      {"relative_noise", number(estimate.relative_noise)},
      {"flags", all_flags(estimate, input)},
  };
  return json.dump(2);
}

std::string interval_text(const DimensionEstimate& estimate) {
  const bool below = estimate.flags & fractal::kOpenBelow, above = estimate.flags & fractal::kOpenAbove;
  if (below && above) return "95 %: anything from 2 to 3";
  if (below) return fmt::format("95 %: at most {:.3f}", estimate.interval95.high);
  if (above) return fmt::format("95 %: at least {:.3f}", estimate.interval95.low);
  return fmt::format("95 %: {:.3f} to {:.3f}", estimate.interval95.low, estimate.interval95.high);
}

std::string as_line(const DimensionEstimate& estimate, const SurveyInput& input, const DimensionOptions& options) {
  std::string line = std::isfinite(estimate.dimension)
                         ? fmt::format("D = {:.3f} ({}), amplitude {:.4g} m at 1 m", estimate.dimension,
                                       interval_text(estimate), estimate.amplitude_m)
                         : fmt::format("D unknown ({}): the noise hides the ground", interval_text(estimate));
  line += fmt::format("; {}, {} {}", estimate.method, estimate.points, input.cells ? "cells" : "points");
  if (input.found > input.x_m.size()) line += fmt::format(" chosen at random of {}", input.found);
  line += fmt::format(", noise {:g} m", options.noise_sigma_m);
  if (options.noise_sigma_m == 0.0 && options.noise_xy_sigma_m == 0.0) line += " assumed (--noise-sigma-m)";
  if (options.noise_xy_sigma_m > 0.0)
    line += fmt::format(" and {:g} m horizontal: {:.3g} m in all", options.noise_xy_sigma_m, estimate.noise_sigma_m);
  if (estimate.flags & fractal::kScaleDependent)
    line += fmt::format("; not one law: D = {:.3f} at {:.3g} m spacing, {:.3f} at {:.3g} m", estimate.dimension,
                        estimate.spacing_m, estimate.coarse_dimension, estimate.coarse_spacing_m);
  for (const auto& flag : all_flags(estimate, input))
    if (flag != "scale_dependent" && flag != "open_below" && flag != "open_above" && flag != "sampled")
      line += "; " + flag;
  return line;
}

Status check(const DimensionOptions& options) {
  const std::array<std::pair<const char*, double>, 2> noises{
      {{"--noise-sigma-m", options.noise_sigma_m}, {"--noise-xy-sigma-m", options.noise_xy_sigma_m}}};
  for (const auto& [name, value] : noises)
    if (!(value >= 0.0 && std::isfinite(value)))
      return Error{ErrorKind::usage, fmt::format("{}: expected metres of at least 0, found {}", name, value)};
  return {};
}

Result<int> run_dimension(const DimensionOptions& options) {
  if (Status status = check(options); !status) return status.error();
  const auto input = read_survey(options.input, options.reading);
  if (!input) return input.error();
  const auto found = estimate(options.method, {.x_m = input->x_m,
                                               .y_m = input->y_m,
                                               .z_m = input->z_m,
                                               .noise_sigma_m = options.noise_sigma_m,
                                               .noise_xy_sigma_m = options.noise_xy_sigma_m,
                                               .height_resolution_m = input->height_resolution_m});
  if (!found) return Error{found.error().kind, options.input + ": " + found.error().message};
  std::puts((options.json ? as_json(*found, *input, options) : as_line(*found, *input, options)).c_str());
  return 0;
}

}  // namespace

Command add_dimension(CLI::App& app) {
  auto options = std::make_shared<DimensionOptions>();
  CLI::App* command = app.add_subcommand("dimension", "Fractal dimension D of points or of a DEM, with an interval");
  command->add_option("INPUT", options->input, "Points (.xyz .txt .csv .bin .pcd .ply) or a raster")->required();
  command->add_option("--method", options->method, "Estimator; auto chooses and says which")
      ->check(CLI::IsMember(method_names()))
      ->type_name("NAME");
  command->add_option("--noise-sigma-m", options->noise_sigma_m, "Known noise of a height; default 0")->type_name("S");
  command->add_option("--noise-xy-sigma-m", options->noise_xy_sigma_m, "Known noise of each horizontal coordinate")
      ->type_name("S");
  command->add_flag("--geographic", options->reading.geographic, "Scale a raster in degrees to metres");
  command->add_option("--max-points", options->reading.max_points, "Of more, a random choice; default 200000")
      ->type_name("N");
  command->add_flag("--json", options->json, "Print one JSON document");
  return {command, [options] { return run_dimension(*options); }};
}

}  // namespace scree::node
