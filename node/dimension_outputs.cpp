#include "node/dimension_outputs.hpp"

#include <array>
#include <cmath>
#include <fmt/format.h>
#include <utility>

#include "fractal/anisotropy.hpp"
#include "io/drawing.hpp"
#include "node/dimension_plot.hpp"
#include "node/length_text.hpp"
#include "node/survey_grid.hpp"

namespace scree::node {
namespace {

Status check_map_options(const DimensionOutputOptions& options) {
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

}  // namespace

Result<DimensionOutputs> DimensionOutputs::prepare(const DimensionOutputOptions& options) {
  if (Status status = check_map_options(options); !status) return status.error();
  DimensionOutputs outputs;
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

Status look_at_cells(const DimensionOutputOptions& options, const DimensionOutputs& outputs, Executor& executor,
                     DimensionReport& report) {
  if (!outputs.maps && !options.anisotropy) return {};
  GriddingOptions gridding;
  gridding.cell_m = options.cell_m;
  gridding.spacing_m = report.answer.estimate.spacing_m;
  gridding.noise_sigma_m = report.answer.raw_heights ? report.request.noise_sigma_m : report.answer.noise_sigma_m;
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
  return {};
}

Status write_plot(const std::filesystem::path& input, const DimensionReport& report, const std::filesystem::path& file,
                  Executor& executor) {
  const auto plot = dimension_plot(input.filename().string(), report, executor);
  if (!plot) return plot.error();
  return io::write_drawing(file, io::draw_loglog_plot(*plot));
}

}  // namespace scree::node
