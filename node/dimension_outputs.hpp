#pragma once
// What `scree dimension` makes beside the answer: cell by cell (maps, anisotropy), and the plot.

#include <filesystem>
#include <optional>
#include <string>

#include "core/executor.hpp"
#include "core/result.hpp"
#include "node/dimension_report.hpp"
#include "node/layer_files.hpp"

namespace scree::node {

struct DimensionOutputOptions {
  double window_m = 0.0, cell_m = 0.0;  ///< 0 = not given
  std::string out, plot;                ///< empty = not given
  bool anisotropy = false;
};

/// Files to write, checked before the work starts.
struct DimensionOutputs {
  std::optional<LayerFiles> maps;
  std::optional<std::filesystem::path> plot;

  /// Errors: usage (options that need each other, lengths, file names), cannot_create.
  static Result<DimensionOutputs> prepare(const DimensionOutputOptions& options);
};

/// Fills in the report's anisotropy and maps, and writes the latter. Errors: those of grid_survey, analyse_anisotropy
/// and write_dimension_maps.
Status look_at_cells(const DimensionOutputOptions& options, const DimensionOutputs& outputs, Executor& executor,
                     DimensionReport& report);

/// Errors: those of dimension_plot and io::write_drawing.
Status write_plot(const std::filesystem::path& input, const DimensionReport& report, const std::filesystem::path& file,
                  Executor& executor);

}  // namespace scree::node
