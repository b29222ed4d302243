#pragma once
// `--window-m W --out BASE.EXT`: D, its standard deviation and the amplitude in a window around every cell, as files.

#include <array>
#include <cstddef>
#include <string>

#include "core/executor.hpp"
#include "core/result.hpp"
#include "fractal/dimension_map.hpp"
#include "node/layer_files.hpp"
#include "node/survey_grid.hpp"

namespace scree::node {

/// What came of the maps.
struct MapsSummary {
  double cell_m = 0.0;
  int window_cells = 0;  ///< side of the square window
  int rows = 0, columns = 0;
  std::size_t known_cells = 0;      ///< with a height
  std::size_t dimension_cells = 0;  ///< with a D
  double median_dimension = 0.0;    ///< NaN without any
  std::size_t too_little_data = 0, noise_limited = 0, not_fractal = 0, anisotropic = 0,
              at_bound = 0;  ///< cells flagged so
};

/// The radius of the smallest window of whole cells, odd in number, that is not narrower than `window_m`, at most the
/// grid's own size. Errors: usage (a window of fewer than 9 cells, which the longest increments do not fit into).
Result<int> window_radius(const SurveyGrid& grid, double window_m);

/// DimensionMapper over the whole grid, in strips of rows that fit into memory: the same values as in one piece, up to
/// rounding.
fractal::DimensionMap map_dimension(const SurveyGrid& grid, int radius_cells, Executor& executor,
                                    int strip_cells = 1 << 21);

/// BASE.dimension.EXT, BASE.dimension_sigma.EXT, BASE.amplitude.EXT (NaN = too little data) and
/// BASE.dimension_flags.EXT (sums of DimensionFlag). Errors: those of window_radius and LayerFiles::write.
Result<MapsSummary> write_dimension_maps(const SurveyGrid& grid, double window_m, const LayerFiles& files,
                                         Executor& executor);

/// One line on the files.
std::string maps_line(const MapsSummary& summary, const LayerFiles& files);

}  // namespace scree::node
