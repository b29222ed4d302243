#pragma once
// The grid that a reconstruction fills, and the survey's heights in its frame.

#include <optional>
#include <string>

#include "core/result.hpp"
#include "fractal/reconstruction/surface_problem.hpp"
#include "node/survey_grid.hpp"
#include "node/survey_input.hpp"

namespace scree::node {

/// Outer borders of a grid, map metres.
struct Extent {
  double x_min_m = 0.0, y_min_m = 0.0, x_max_m = 0.0, y_max_m = 0.0;
};

/// "XMIN,YMIN,XMAX,YMAX". Errors: usage (not four finite numbers, no area).
Result<Extent> parse_extent(const std::string& text);

struct ReconstructionGridOptions {
  double cell_m = 0.0;           ///< 0 = a raster's own
  std::optional<Extent> extent;  ///< none = the samples' bounding box grown to whole cells; a raster's own grid
};

struct PlacedSurvey {
  fractal::SurfaceGrid grid;
  LayerPlace place;                ///< of the grid, for files
  fractal::HeightSamples samples;  ///< within the grid; variances are 0
  std::size_t outside = 0;         ///< samples left out
};

/// Largest number of cells of a grid: 8192 × 8192.
inline constexpr double kMostSurfaceCells = 8192.0 * 8192.0;

/// Errors: usage (no cell for scattered points; an extent that is not a whole number of cells, with the nearest one
/// that is), bad_data (oblong cells, more than kMostSurfaceCells, no sample within the extent).
Result<PlacedSurvey> place_survey(const SurveyInput& survey, const ReconstructionGridOptions& options);

/// The values of a raster's cells in which the centres of the grid's cells lie; NaN where it has none. Errors: those of
/// io::read_raster.
Result<Grid<float>> read_at_cells(const std::string& file, const PlacedSurvey& placed);

}  // namespace scree::node
