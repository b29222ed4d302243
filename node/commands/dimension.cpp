// scree dimension: D of points, of a DEM or of a recording.

#include <CLI/CLI.hpp>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <memory>
#include <optional>
#include <spdlog/spdlog.h>
#include <string>
#include <utility>

#include "core/executor.hpp"
#include "fractal/anisotropy.hpp"
#include "io/drawing.hpp"
#include "node/commands/command_line.hpp"
#include "node/dimension_maps.hpp"
#include "node/dimension_methods.hpp"
#include "node/dimension_plot.hpp"
#include "node/dimension_report.hpp"
#include "node/layer_files.hpp"
#include "node/survey_grid.hpp"
#include "node/survey_input.hpp"

namespace scree::node {
namespace {

struct DimensionOptions {
  std::string input;
  DimensionRequest request;
  SurveyReading reading;
  std::string noise = "0";
  std::string segment = "least-squares";
  double window_m = 0.0, cell_m = 0.0;  // 0 = not given
  std::string out, plot;
  bool anisotropy = false, json = false;
};

/// Files to write, checked before the work.
struct Outputs {
  std::optional<LayerFiles> maps;
  std::optional<std::filesystem::path> plot;
};

Status check_length(const char* option, double value, const char* meaning) {
  if (value >= 0.0 && std::isfinite(value)) return {};
  return Error{ErrorKind::usage, fmt::format("{}: expected {}, found {}", option, meaning, value)};
}

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
  request.segmentation =
      options.segment == "polyline" ? fractal::Segmentation::polyline : fractal::Segmentation::least_squares;
  return {};
}

Status check_map_options(const DimensionOptions& options) {
  const bool window = options.window_m != 0.0, out = !options.out.empty();
  if (window != out)
    return Error{ErrorKind::usage,
                 fmt::format("{0}: expected {1} beside it (maps need both), found none",
                             window ? "--window-m" : "--out", window ? "--out BASE.EXT" : "--window-m W")};
  if (options.cell_m != 0.0 && !window && !options.anisotropy)
    return Error{ErrorKind::usage, "--cell-m: expected --anisotropy or --window-m and --out beside it, found neither"};
  const std::array<std::pair<const char*, double>, 2> lengths{
      {{"--window-m", options.window_m}, {"--cell-m", options.cell_m}}};
  for (const auto& [name, value] : lengths)
    if (Status status = check_length(name, value, "metres above 0"); !status) return status;
  return {};
}

Result<Outputs> check_outputs(const DimensionOptions& options) {
  if (Status status = check_map_options(options); !status) return status.error();
  Outputs outputs;
  if (!options.out.empty()) {
    auto files = LayerFiles::prepare("--out", options.out);
    if (!files) return files.error();
    if (Status status = check_creatable(files->file("dimension")); !status) return status.error();
    outputs.maps = *std::move(files);
  }
  if (!options.plot.empty()) {
    if (Status status = check_picture_path("--plot", options.plot); !status) return status.error();
    outputs.plot = options.plot;
  }
  return outputs;
}

/// What is computed cell by cell.
Status look_at_cells(const DimensionOptions& options, const Outputs& outputs, Executor& executor,
                     DimensionReport& report) {
  if (!outputs.maps && !options.anisotropy) return {};
  GriddingOptions gridding;
  gridding.cell_m = options.cell_m;
  gridding.spacing_m = report.answer.estimate.spacing_m;
  gridding.noise_sigma_m = report.answer.noise_sigma_m;
  const auto grid = grid_survey(report.input, gridding);
  if (!grid) return grid.error();
  if (options.anisotropy) {
    auto found = fractal::analyse_anisotropy(grid->height_m, grid->cell_m, grid->variance_m2, grid->hits, executor);
    if (!found) return found.error();
    report.anisotropy = *found;
  }
  if (!outputs.maps) return {};
  auto summary = write_dimension_maps(*grid, options.window_m, *outputs.maps, executor);
  if (!summary) return summary.error();
  report.maps = *summary;
  if (!options.json) spdlog::info("{}", maps_line(*summary, *outputs.maps));
  return {};
}

Status make_plot(const DimensionOptions& options, const DimensionReport& report, const std::filesystem::path& file,
                 Executor& executor) {
  const auto plot = dimension_plot(std::filesystem::path(options.input).filename().string(), report, executor);
  if (!plot) return plot.error();
  return io::write_drawing(file, io::draw_loglog_plot(*plot));
}

Result<int> run_dimension(DimensionOptions options) {
  if (Status status = complete(options); !status) return status.error();
  const auto outputs = check_outputs(options);
  if (!outputs) return outputs.error();
  const auto input = read_survey(options.input, options.reading);
  if (!input) return input.error();
  SerialExecutor executor;
  const auto answer = find_dimension(*input, options.request, executor);
  if (!answer) return Error{answer.error().kind, options.input + ": " + answer.error().message};
  DimensionReport report{*input, options.request, *answer, {}, {}};
  const auto named = [&](const Error& error) { return Error{error.kind, options.input + ": " + error.message}; };
  if (Status status = look_at_cells(options, *outputs, executor, report); !status) return named(status.error());
  if (outputs->plot)
    if (Status status = make_plot(options, report, *outputs->plot, executor); !status) return named(status.error());
  if (!options.json)
    for (const std::string& remark : dimension_remarks(report)) spdlog::warn("{}", remark);
  if (Status status = print(options.json ? dimension_json(report) : dimension_line(report)); !status)
    return status.error();
  return 0;
}

void add_output_options(CLI::App& command, DimensionOptions& options) {
  command.add_option("--window-m", options.window_m, "Maps of D in windows this wide around every cell")
      ->type_name("W");
  command.add_option("--out", options.out, "Where the maps go: BASE.dimension.EXT and others; tif, npy or png")
      ->type_name("BASE.EXT");
  command.add_flag("--anisotropy", options.anisotropy, "Test whether the ground is rougher in one direction");
  command
      .add_option("--cell-m", options.cell_m, "Cells that scattered points are averaged in; default their mean spacing")
      ->type_name("M");
  command.add_option("--plot", options.plot, "Log-log plot of height change against distance")->type_name("FILE.png");
  command.add_flag("--json", options.json, "Print one JSON document");
}

void add_input_options(CLI::App& command, SurveyReading& reading) {
  command.add_flag("--geographic", reading.geographic, "Scale a raster in degrees to metres");
  command.add_option("--max-points", reading.max_points, "Of more, a random choice; default 200000")->type_name("N");
  command.add_option("--frames", reading.frames, "Of a recording, the first N only")->type_name("N");
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
  command->add_option("--segment", options->segment, "How yokoya and pentland find the linear part of their plot")
      ->check(CLI::IsMember({"polyline", "least-squares"}))
      ->type_name("polyline|least-squares");
  add_input_options(*command, options->reading);
  add_seed(*command, [options](std::uint64_t seed) { options->reading.seed = options->request.seed = seed; });
  add_output_options(*command, *options);
  return {command, [options] { return run_dimension(*options); }};
}

}  // namespace scree::node
