#pragma once
// Georeferenced rasters through GDAL.

#include <filesystem>
#include <string>

#include "core/grid.hpp"
#include "core/result.hpp"

namespace scree::io {

/// A north-up elevation raster, turned so that row 0 is the smallest y. (x_min_m, y_min_m) is the outer corner of
/// cell (0, 0). NaN = no data. Band 1, scale and offset applied, float32 metres.
struct Raster {
  Grid<float> height_m;
  double x_min_m = 0.0;
  double y_min_m = 0.0;
  double cell_m = 1.0;       ///< of x
  double cell_y_m = 1.0;     ///< of y; equal to cell_m but for rasters with oblong cells
  bool geographic = false;   ///< cells are degrees, by the CRS or by plausibility (see message of the caller)
  std::string crs_wkt = {};  ///< as the file has it; empty = none
  bool placed = true;        ///< the file says how large its cells are; otherwise (a plain picture) they count as 1 m
};

/// Any format GDAL reads. A raster without a CRS counts as geographic when it lies within ±360 × ±90 and its heights,
/// taken as metres over its cells, would be a wall (median slope above 30). Errors: no_input, bad_data (rotated or
/// mirrored rasters, no band, complex numbers, a CRS in feet or a height unit other than metres, a band without one
/// finite value); `unavailable` in a build without GDAL.
Result<Raster> read_raster(const std::filesystem::path& file);

/// The message for whoever needs metres and got a geographic raster: what was found and how to reproject it.
Error geographic_error(const Raster& raster, const std::string& name);

/// Float32 GeoTIFF, deflate, north up, nodata NaN, with the CRS of `raster` (none: map frame). Errors: cannot_create,
/// io.
Status write_geotiff(const std::filesystem::path& file, const Raster& raster);

}  // namespace scree::io
