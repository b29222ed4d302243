#pragma once
// Terrain from elevation rasters, dense surveys and fractal laws.

#include <Eigen/Core>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.hpp"
#include "drivers/terrain.hpp"
#include "io/raster.hpp"

namespace scree::drivers {

/// How a dense survey becomes a surface; the choices are argued in docs/simulator.md.
struct SurveyGridding {
  double cell_m = 0.0;  ///< 0 = survey_cell_m
  double flat_spread_m =
      0.2;  ///< cells whose highest and lowest points differ by less hold their mean, others their top
};

inline constexpr std::string_view kTerrainGrammar =
    "FILE | fbm:D,AMPLITUDE_M,SEED[,EXTENT_M=60[,CELL_M=0.05]] for --terrain";

/// `FILE` (points: .bin .pcd .ply .xyz .txt .csv; anything else a raster that GDAL reads) or
/// `fbm:D,AMPLITUDE_M,SEED[,EXTENT_M=60[,CELL_M=0.05]]`, centred on the origin of the map with height 0 there.
/// Errors: usage (the grammar), no_input, bad_data (not metres, no surface), unavailable (a library not built in).
Result<Terrain> load_terrain(std::string_view specification, const SurveyGridding& gridding = {});

/// Points (rows x y z …, relative to `origin_m`) to the raster of their cells, aligned to multiples of the cell;
/// NaN where no point fell. `name` is for messages. Errors: bad_data (fewer than four points, more cells than 2^28).
Result<io::Raster> grid_survey(const std::vector<Eigen::Vector4f>& points, const Eigen::Vector3d& origin_m,
                               const SurveyGridding& gridding, const std::string& name);

/// The cell that holds about four points where the survey is at its median density, rounded to 1, 2 or 5 · 10^n m.
double survey_cell_m(const std::vector<Eigen::Vector4f>& points);

}  // namespace scree::drivers
