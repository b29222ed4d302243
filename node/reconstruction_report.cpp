#include "node/reconstruction_report.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "node/length_text.hpp"

namespace scree::node {
namespace {

using Json = nlohmann::ordered_json;

Json number(double value) {
  return std::isfinite(value) ? Json(value) : Json();
}

std::size_t unknown_cells(const ReconstructionReport& report) {
  const Grid<float>& mean = report.answer.estimate.mean_m;
  return static_cast<std::size_t>(
      std::count_if(mean.begin(), mean.end(), [](float value) { return !std::isfinite(value); }));
}

double median_sd_m(const ReconstructionReport& report) {
  std::vector<float> known;
  for (const float sd : report.answer.estimate.sd_m)
    if (!std::isnan(sd)) known.push_back(sd);
  if (known.empty()) return std::nan("");
  const auto middle = known.begin() + static_cast<std::ptrdiff_t>(known.size() / 2);
  std::nth_element(known.begin(), middle, known.end());
  return static_cast<double>(*middle);
}

}  // namespace

std::string reconstruction_line(const ReconstructionReport& report) {
  const auto& [rows, columns, cell_m] = report.placed.grid;
  const fractal::LawMap& map = report.law.map;
  std::string line =
      fmt::format("{}: {} x {} cells of {:g} m from {} samples in {} of them, D = {:.3f}{}, amplitude {} m at 1 m",
                  report.method, columns, rows, cell_m, report.placed.samples.size(), report.answer.measured_cells,
                  map.law.dimension, map.varies() ? " (median)" : "", length_text(map.law.amplitude_m));
  line +=
      fmt::format(", noise {} m {}", length_text(report.law.noise_sigma_m), noise_source_text(report.law.noise_source));
  if (const double sd_m = median_sd_m(report); std::isfinite(sd_m))
    line += fmt::format("; sd {} m in the middle", length_text(sd_m));
  if (std::isfinite(report.dimension_of_draw)) line += fmt::format(", D of the draw {:.3f}", report.dimension_of_draw);
  return line + fmt::format("; {:.3g} s\n", report.answer.seconds);
}

std::vector<std::string> reconstruction_remarks(const ReconstructionReport& report) {
  std::vector<std::string> remarks;
  if (report.placed.outside > 0)
    remarks.push_back(fmt::format("{} samples lie outside the extent", report.placed.outside));
  if (report.law.contradictory)
    remarks.push_back(
        fmt::format("contradictory samples: heights at one place differ by {} m, the noise is {} m; they "
                    "are averaged",
                    length_text(report.law.repeat_sigma_m), length_text(report.law.noise_sigma_m)));
  if (const std::size_t cells = report.answer.estimate.rejected_cells; cells > 0)
    remarks.push_back(
        fmt::format("{} of {} measured cells are no ground of this law and were left out (BASE.rejected; "
                    "--keep-outliers keeps them)",
                    cells, report.answer.measured_cells));
  if (report.answer.estimate.law_contradicted)
    remarks.emplace_back(
        "law_contradicted: over a quarter of the samples are no ground of this D and amplitude; all were kept, and sd "
        "is "
        "not to be trusted");
  if (!report.answer.estimate.converged)
    remarks.emplace_back("not converged: the surface is short of its law; are D and the noise right?");
  if (const std::size_t cells = unknown_cells(report); cells > 0)
    remarks.push_back(fmt::format("{} cells have no height (nan): outside the hull of the samples", cells));
  if (report.law.found && !report.law.found->flags.empty())
    remarks.push_back(
        fmt::format("D of the samples: {} (scree dimension says more)", fmt::join(report.law.found->flags, ", ")));
  return remarks;
}

std::string reconstruction_json(const ReconstructionReport& report) {
  const fractal::LawMap& map = report.law.map;
  const fractal::SurfaceEstimate& estimate = report.answer.estimate;
  Json json{{"method", report.method},
            {"dimension", number(map.law.dimension)},
            {"amplitude_m", number(map.law.amplitude_m)},
            {"law_varies", map.varies()},
            {"dimension_estimated", report.law.found.has_value()},
            {"dimension_of_draw", number(report.dimension_of_draw)},
            {"iterations", estimate.iterations},
            {"converged", estimate.converged},
            {"seconds", report.answer.seconds},
            {"noise_sigma_m", report.law.noise_sigma_m},
            {"noise_source", noise_source_text(report.law.noise_source)},
            {"rows", report.placed.grid.rows},
            {"columns", report.placed.grid.columns},
            {"cell_m", report.placed.grid.cell_m},
            {"x_min_m", report.placed.place.raster.x_min_m},
            {"y_min_m", report.placed.place.raster.y_min_m},
            {"repeated_samples", report.law.repeats},
            {"repeat_sigma_m", number(report.law.repeat_sigma_m)},
            {"contradictory", report.law.contradictory},
            {"samples", report.placed.samples.size()},
            {"samples_outside", report.placed.outside},
            {"samples_skipped", report.input.skipped},
            {"measured_cells", report.answer.measured_cells},
            {"law_contradicted", estimate.law_contradicted},
            {"rejected_cells", estimate.rejected_cells},
            {"unknown_cells", unknown_cells(report)},
            {"median_sd_m", number(median_sd_m(report))},
            {"draws", report.draws},
            {"flags", report.law.found ? Json(report.law.found->flags) : Json::array()}};
  return json.dump(2) + "\n";
}

}  // namespace scree::node
