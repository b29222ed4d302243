#pragma once
// Georeferenced rasters through GDAL.

#include <filesystem>

#include "core/grid.hpp"
#include "core/result.hpp"

namespace scree::io {

/// A north-up elevation raster, turned so that row 0 is the smallest y. (x_min_m, y_min_m) is the outer corner of
/// cell (0, 0). NaN = no data. Band 1, scale and offset applied, float32 metres.
struct Raster {
  Grid<float> height_m;
  double x_min_m = 0.0;
  double y_min_m = 0.0;
  double cell_m = 1.0;      ///< of x
  double cell_y_m = 1.0;    ///< of y; equal to cell_m but for rasters with oblong cells
  bool geographic = false;  ///< cells are degrees, by the CRS or by plausibility (see message of the caller)
};

/// Any format GDAL reads. Errors: no_input, bad_data (rotated rasters, no band, not a number).
Result<Raster> read_raster(const std::filesystem::path& file);

/// Float32 GeoTIFF, deflate. Errors: cannot_create, io.
Status write_geotiff(const std::filesystem::path& file, const Raster& raster);

}  // namespace scree::io
