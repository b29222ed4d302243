// scree dimension: D of points, of a DEM or of a recording.

#include <CLI/CLI.hpp>
#include <array>
#include <charconv>
#include <memory>
#include <spdlog/spdlog.h>
#include <string>
#include <utility>

#include "core/executor.hpp"
#include "node/commands/command_line.hpp"
#include "node/dimension_methods.hpp"
#include "node/dimension_outputs.hpp"
#include "node/dimension_report.hpp"
#include "node/length_text.hpp"
#include "node/survey_input.hpp"

namespace scree::node {
namespace {

struct DimensionOptions {
  std::string input;
  DimensionRequest request;
  SurveyReading reading;
  std::string noise = "0";
  std::string segment;  ///< empty = not given
  DimensionOutputOptions output;
  bool json = false;
};

/// A number, or "auto".
Status read_noise(const std::string& text, DimensionRequest& request) {
  request.noise_auto = text == "auto";
  if (request.noise_auto) return {};
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), request.noise_sigma_m);
  if (status == std::errc() && end == text.data() + text.size())
    return check_length("--noise-sigma-m", request.noise_sigma_m, "metres of at least 0, or auto");
  return Error{ErrorKind::usage, "--noise-sigma-m: expected metres of at least 0, or auto, found '" + text + "'"};
}

/// Options that the parser has only taken as text or number.
Status complete(DimensionOptions& options) {
  auto& request = options.request;
  if (Status status = read_noise(options.noise, request); !status) return status;
  const std::array<std::pair<const char*, double>, 2> lengths{
      {{"--noise-xy-sigma-m", request.noise_xy_sigma_m}, {"--max-lag-m", request.max_lag_m}}};
  for (const auto& [name, value] : lengths)
    if (Status status = check_length(name, value, "metres of at least 0"); !status) return status;
  if (!options.segment.empty() && request.method != "yokoya" && request.method != "pentland")
    return Error{ErrorKind::usage,
                 "--segment: expected --method yokoya or pentland beside it, found " + request.method};
  request.segmentation =
      options.segment == "polyline" ? fractal::Segmentation::polyline : fractal::Segmentation::least_squares;
  return {};
}

Result<int> run_dimension(DimensionOptions options) {
  if (Status status = complete(options); !status) return status.error();
  const auto outputs = DimensionOutputs::prepare(options.output);
  if (!outputs) return outputs.error();
  const auto input = read_survey(options.input, options.reading);
  if (!input) return input.error();
  SerialExecutor executor;
  const auto answer = find_dimension(*input, options.request, executor);
  if (!answer) return Error{answer.error().kind, options.input + ": " + answer.error().message};
  DimensionReport report{*input, options.request, *answer, {}, {}};
  const auto named = [&](const Error& error) { return Error{error.kind, options.input + ": " + error.message}; };
  if (Status status = look_at_cells(options.output, *outputs, executor, report); !status) return named(status.error());
  if (outputs->plot)
    if (Status status = write_plot(options.input, report, *outputs->plot, executor); !status)
      return named(status.error());
  if (!options.json) {
    if (report.maps) spdlog::info("{}", maps_line(*report.maps, *outputs->maps));
    for (const std::string& remark : dimension_remarks(report)) spdlog::warn("{}", remark);
  }
  if (Status status = print(options.json ? dimension_json(report) : dimension_line(report)); !status)
    return status.error();
  return 0;
}

/// The parser takes -1 for 2^64 - 1.
std::string at_least_zero(const std::string& text) {
  return text.starts_with('-') ? "expected a number of at least 0, found " + text : "";
}

void add_output_options(CLI::App& command, DimensionOptions& options) {
  command.add_option("--window-m", options.output.window_m, "Maps of D in windows this wide around every cell")
      ->type_name("W");
  command.add_option("--out", options.output.out, "Where the maps go: BASE.dimension.EXT and others; tif, npy or png")
      ->type_name("BASE.EXT");
  command.add_flag("--anisotropy", options.output.anisotropy, "Test whether the ground is rougher in one direction");
  command
      .add_option("--cell-m", options.output.cell_m,
                  "Cells that scattered points are averaged in; default their mean spacing")
      ->type_name("M");
  command.add_option("--plot", options.output.plot, "Log-log plot of height change against distance")
      ->type_name("FILE.png");
  command.add_flag("--json", options.json, "Print one JSON document");
}

void add_input_options(CLI::App& command, SurveyReading& reading) {
  command.add_flag("--geographic", reading.geographic, "Scale a raster in degrees to metres");
  command.add_option("--max-points", reading.max_points, "Of more, a random choice; default 200000")
      ->check(at_least_zero)
      ->type_name("N");
  command.add_option("--frames", reading.frames, "Of a recording, the first N only")
      ->check(at_least_zero)
      ->type_name("N");
  command.add_option("--format", reading.format, "Of a directory that is not a recording of Scree: kitti, pcd")
      ->check(CLI::IsMember({"auto", "kitti", "pcd"}))
      ->type_name("FORMAT");
}

}  // namespace

Command add_dimension(CLI::App& app) {
  auto options = std::make_shared<DimensionOptions>();
  CLI::App* command = app.add_subcommand("dimension", "Fractal dimension D of points or of a DEM, with an interval");
  command->add_option("INPUT", options->input, "Points (.xyz .txt .csv .bin .pcd .ply), a raster or a recording")
      ->required();
  command->add_option("--method", options->request.method, "Estimator; auto chooses and says which")
      ->check(CLI::IsMember(dimension_methods()))
      ->type_name("NAME");
  command->add_option("--noise-sigma-m", options->noise, "Known noise of a height; default 0")->type_name("S|auto");
  command
      ->add_option("--noise-xy-sigma-m", options->request.noise_xy_sigma_m, "Known noise of each horizontal coordinate")
      ->type_name("S");
  command->add_option("--max-lag-m", options->request.max_lag_m, "Longest distance looked at by methods with lags")
      ->type_name("M");
  command
      ->add_option("--segment", options->segment,
                   "How yokoya and pentland find the linear part of their plot; default least-squares")
      ->check(CLI::IsMember({"polyline", "least-squares"}))
      ->type_name("polyline|least-squares");
  add_input_options(*command, options->reading);
  add_seed(*command, [options](std::uint64_t seed) { options->reading.seed = options->request.seed = seed; });
  add_output_options(*command, *options);
  return {command, [options] { return run_dimension(*options); }};
}

}  // namespace scree::node
