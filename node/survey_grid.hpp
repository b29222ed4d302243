#pragma once
// A survey as a grid of square cells, for what is computed cell by cell: maps of D, anisotropy.

#include <cstdint>

#include "core/grid.hpp"
#include "core/result.hpp"
#include "io/picture.hpp"
#include "io/raster.hpp"
#include "node/survey_input.hpp"

namespace scree::node {

/// Where a layer of the grid belongs: georeference of files (no heights in it) and metres of pictures.
struct LayerPlace {
  io::Raster raster;
  io::PictureFrame picture;
};

/// Three grids of one shape, row 0 at the smallest y (DimensionMapper::update).
struct SurveyGrid {
  Grid<float> height_m;  ///< NaN = no data
  Grid<float> variance_m2;
  Grid<std::uint16_t> hits;  ///< points averaged in the cell; all 0 for a raster, whose values count as heights of the
                             ///< cells' centres
  double cell_m = 1.0;
  LayerPlace place;
};

struct GriddingOptions {
  double cell_m = 0.0;     ///< of scattered points; 0 = their mean spacing. A raster has its own
  double spacing_m = 0.0;  ///< mean spacing of the estimator's points
  double noise_sigma_m = 0.0;
  int level_radius_cells = 3;  ///< window of the plane along which means are moved to cell centres
};

/// A raster's own cells, or scattered points averaged in the cells of a lattice aligned to the origin of their
/// coordinates. Errors: usage (a cell for a raster), bad_data (oblong cells, a grid of more than 2^25 cells).
Result<SurveyGrid> grid_survey(const SurveyInput& survey, const GriddingOptions& options);

}  // namespace scree::node
