#include "io/raster.hpp"

#include <cmath>
#include <fmt/format.h>

#ifdef SCREE_WITH_GDAL

#include <algorithm>
#include <array>
#include <cstddef>
#include <gdal_priv.h>
#include <limits>
#include <memory>
#include <mutex>
#include <ogr_spatialref.h>
#include <system_error>
#include <vector>

namespace scree::io {
namespace {

struct Close {
  void operator()(GDALDataset* dataset) const { GDALClose(dataset); }
};
using Dataset = std::unique_ptr<GDALDataset, Close>;

/// GDAL's own reports are taken from CPLGetLastErrorMsg, not from its stderr.
void register_once() {
  static std::once_flag once;
  std::call_once(once, [] {
    GDALAllRegister();
    CPLSetErrorHandler(CPLQuietErrorHandler);
  });
}

Error bad(const std::filesystem::path& file, const std::string& expected, const std::string& found) {
  return {ErrorKind::bad_data, fmt::format("{}: expected {}, found {}", file.string(), expected, found)};
}

/// A CRS in metres, or none at all; degrees are the caller's to refuse.
Status check_units(const std::filesystem::path& file, GDALDataset& dataset, GDALRasterBand& band, bool& geographic) {
  if (const OGRSpatialReference* crs = dataset.GetSpatialRef(); crs != nullptr) {
    geographic = crs->IsGeographic() != 0;
    const char* unit = nullptr;
    const double metres = geographic || crs->IsProjected() == 0 ? 1.0 : crs->GetLinearUnits(&unit);
    if (std::abs(metres - 1.0) > 1e-9)
      return bad(file, "a CRS in metres", fmt::format("cells in {} ({} m); try: gdalwarp -t_srs …", unit, metres));
  }
  const std::string unit = band.GetUnitType();
  if (!unit.empty() && unit != "m" && unit != "metre" && unit != "meter" && unit != "metres" && unit != "meters")
    return bad(file, "heights in metres", "the unit '" + unit + "'");
  return {};
}

using GeoTransform = std::array<double, 6>;  // x = [0] + column·[1] + row·[2], y = [3] + column·[4] + row·[5]

/// Nothing for plain pictures.
std::optional<GeoTransform> file_transform(GDALDataset& dataset) {
  GeoTransform transform{};
  return dataset.GetGeoTransform(transform.data()) == CE_None ? std::optional(transform) : std::nullopt;
}

GeoTransform geo_transform(GDALDataset& dataset) {
  return file_transform(dataset).value_or(
      GeoTransform{0, 1, 0, static_cast<double>(dataset.GetRasterYSize()), 0, -1});  // one metre a cell
}

Result<Raster> read_geometry(const std::filesystem::path& file, GDALDataset& dataset) {
  const GeoTransform transform = geo_transform(dataset);
  const int rows = dataset.GetRasterYSize();
  if (transform[2] != 0.0 || transform[4] != 0.0)
    return bad(file, "a north-up raster", fmt::format("a rotated one (terms {} and {})", transform[2], transform[4]));
  if (!(transform[1] > 0.0) || transform[5] == 0.0 || !std::isfinite(transform[1]) || !std::isfinite(transform[5]))
    return bad(file, "cells of positive size", fmt::format("{} × {}", transform[1], transform[5]));
  Raster raster;
  raster.placed = file_transform(dataset).has_value();
  raster.cell_m = transform[1];
  raster.cell_y_m = std::abs(transform[5]);
  raster.x_min_m = transform[0];
  raster.y_min_m = transform[5] < 0.0 ? transform[3] + rows * transform[5] : transform[3];
  raster.height_m.assign(rows, dataset.GetRasterXSize(), std::numeric_limits<float>::quiet_NaN());
  return raster;
}

/// Band 1 into the grid, row 0 at the smallest y. Nodata is compared before scale and offset, in double, as GDAL does.
Status read_heights(const std::filesystem::path& file, GDALDataset& dataset, GDALRasterBand& band, Raster& raster) {
  const bool north_up = geo_transform(dataset)[5] < 0.0;
  int has_nodata = 0;
  const double nodata = band.GetNoDataValue(&has_nodata);
  const double scale = band.GetScale(), offset = band.GetOffset();
  const bool single = band.GetRasterDataType() == GDT_Float32;  // its nodata is often written with fewer digits
  const int rows = raster.height_m.rows(), columns = raster.height_m.columns();
  std::vector<double> line(static_cast<std::size_t>(columns));
  std::size_t finite = 0;
  for (int r = 0; r < rows; ++r) {
    if (band.RasterIO(GF_Read, 0, r, columns, 1, line.data(), columns, 1, GDT_Float64, 0, 0, nullptr) != CE_None)
      return bad(file, fmt::format("{} rows of {} cells", rows, columns),
                 fmt::format("a failure in row {}: {}", r, CPLGetLastErrorMsg()));
    const auto out = raster.height_m.row(north_up ? rows - 1 - r : r);
    for (int c = 0; c < columns; ++c) {
      const double value = line[static_cast<std::size_t>(c)];
      const bool absent =
          has_nodata != 0 && (value == nodata || (single && static_cast<float>(value) == static_cast<float>(nodata)));
      if (absent || !std::isfinite(value)) continue;
      out[static_cast<std::size_t>(c)] = static_cast<float>(value * scale + offset);
      ++finite;
    }
  }
  if (finite == 0) return bad(file, "at least one height", "nothing but nodata");
  return {};
}

/// Degrees without a CRS give themselves away: the ground would rise by metres over a ten-thousandth of a "metre".
bool looks_geographic(const Raster& raster) {
  const auto& z = raster.height_m;
  if (std::abs(raster.x_min_m) > 360.0 || raster.y_min_m < -90.0) return false;
  if (raster.x_min_m + z.columns() * raster.cell_m > 360.0 || raster.y_min_m + z.rows() * raster.cell_y_m > 90.0)
    return false;
  constexpr float kWall = 30.0F;
  std::vector<float> slopes;
  for (int r = 0; r < z.rows(); ++r)
    for (int c = 1; c < z.columns(); ++c)
      if (const float rise = std::abs(z(r, c) - z(r, c - 1)); rise > 0.0F)
        slopes.push_back(rise / static_cast<float>(raster.cell_m));
  if (slopes.empty()) return false;
  const auto middle = slopes.begin() + static_cast<std::ptrdiff_t>(slopes.size() / 2);
  std::nth_element(slopes.begin(), middle, slopes.end());
  return *middle > kWall;
}

}  // namespace

Result<Raster> read_raster(const std::filesystem::path& file) {
  register_once();
  std::error_code ignored;
  if (!std::filesystem::exists(file, ignored))
    return Error{ErrorKind::no_input, fmt::format("{}: expected a raster, found no such file", file.string())};
  CPLErrorReset();
  const Dataset dataset(GDALDataset::Open(file.c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY));
  if (!dataset) {
    const std::string reason = CPLGetLastErrorMsg();
    return bad(file, "a raster that GDAL reads", reason.empty() ? "a file in no format that it knows" : reason);
  }
  if (dataset->GetRasterCount() < 1) return bad(file, "one raster band", "none");
  GDALRasterBand& band = *dataset->GetRasterBand(1);
  if (GDALDataTypeIsComplex(band.GetRasterDataType()) != 0) return bad(file, "real heights", "complex numbers");

  auto raster = read_geometry(file, *dataset);
  if (!raster) return raster.error();
  if (auto status = check_units(file, *dataset, band, raster->geographic); !status) return status.error();
  if (auto status = read_heights(file, *dataset, band, *raster); !status) return status.error();
  if (dataset->GetSpatialRef() == nullptr && raster->placed) raster->geographic = looks_geographic(*raster);
  if (const char* crs = dataset->GetProjectionRef(); crs != nullptr) raster->crs_wkt = crs;
  return raster;
}

Status write_geotiff(const std::filesystem::path& file, const Raster& raster) {
  register_once();
  const int rows = raster.height_m.rows(), columns = raster.height_m.columns();
  GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("GTiff");
  if (driver == nullptr) return Error{ErrorKind::internal, "GDAL: expected its GTiff driver, found none"};
  char compress[] = "COMPRESS=DEFLATE", predictor[] = "PREDICTOR=3";
  std::array<char*, 3> options{compress, predictor, nullptr};
  CPLErrorReset();
  Dataset dataset(driver->Create(file.c_str(), columns, rows, 1, GDT_Float32, options.data()));
  const auto failed = [&](ErrorKind kind) {
    return Error{kind, fmt::format("{}: cannot be written: {}", file.string(), CPLGetLastErrorMsg())};
  };
  if (!dataset) return failed(ErrorKind::cannot_create);
  GeoTransform transform{raster.x_min_m,  raster.cell_m, 0.0, raster.y_min_m + rows * raster.cell_y_m, 0.0,
                         -raster.cell_y_m};
  dataset->SetGeoTransform(transform.data());
  if (!raster.crs_wkt.empty()) dataset->SetProjection(raster.crs_wkt.c_str());
  GDALRasterBand& band = *dataset->GetRasterBand(1);
  band.SetNoDataValue(std::numeric_limits<double>::quiet_NaN());
  for (int r = 0; r < rows; ++r) {
    auto line = raster.height_m.row(rows - 1 - r);
    if (band.RasterIO(GF_Write, 0, r, columns, 1, const_cast<float*>(line.data()), columns, 1, GDT_Float32, 0, 0,
                      nullptr) != CE_None)
      return failed(ErrorKind::io);
  }
  dataset->FlushCache();
  dataset.reset();  // deflated blocks reach the disk here at the latest
  if (CPLGetLastErrorType() >= CE_Failure) return failed(ErrorKind::io);
  return {};
}

#else

namespace scree::io {

namespace {
Error without_gdal(const std::filesystem::path& file) {
  return {ErrorKind::unavailable,
          fmt::format("{}: rasters need a build with GDAL (SCREE_WITH_GDAL), this one has none", file.string())};
}
}  // namespace

Result<Raster> read_raster(const std::filesystem::path& file) {
  return without_gdal(file);
}

Status write_geotiff(const std::filesystem::path& file, const Raster&) {
  return without_gdal(file);
}

#endif

Error geographic_error(const Raster& raster, const std::string& name) {
  // Square cells with the area of the raster's in its middle.
  constexpr double kMetresADegree = 111'195.0, kRadians = 0.017453292519943295;
  const double latitude = raster.y_min_m + 0.5 * raster.height_m.rows() * raster.cell_y_m;
  const double side_m = kMetresADegree * std::sqrt(raster.cell_m * raster.cell_y_m * std::cos(latitude * kRadians));
  return {
      ErrorKind::bad_data,
      fmt::format("{4}: expected cells in metres, found degrees ({0:.6g} × {1:.6g} at x {2:.6g}, y {3:.6g}); reproject "
                  "first: gdalwarp -s_srs EPSG:4326 -t_srs EPSG:326NN -tr {5:.3g} {5:.3g} -r bilinear IN OUT.tif "
                  "(NN = UTM zone; 327NN in the south)",
                  raster.cell_m, raster.cell_y_m, raster.x_min_m, raster.y_min_m, name, side_m)};
}

}  // namespace scree::io
