#include "io/raster.hpp"

#include <cmath>
#include <cstring>
#include <fstream>
#include <gtest/gtest.h>
#include <limits>
#include <unistd.h>

#include "tests/support/shared_data.hpp"

namespace scree::io {
namespace {

/// A folder of this process that goes with it.
struct Scratch {
  std::filesystem::path folder =
      std::filesystem::path(testing::TempDir()) / ("scree_raster_" + std::to_string(getpid()));
  Scratch() { std::filesystem::create_directories(folder); }
  ~Scratch() {
    std::error_code ignored;
    std::filesystem::remove_all(folder, ignored);
  }
};

std::filesystem::path scratch(const std::string& name) {
  static const Scratch scratch;
  return scratch.folder / name;
}

std::filesystem::path write_text(const std::string& name, const std::string& text) {
  const auto file = scratch(name);
  std::ofstream(file) << text;
  return file;
}

/// Skips in builds whose adapter is left out.
#define SKIP_WITHOUT_GDAL(result) \
  if (!(result) && (result).error().kind == ErrorKind::unavailable) GTEST_SKIP() << (result).error().message

TEST(Raster, AsciiGridIsTurnedSoThatRowZeroIsTheSouth) {
  const auto file = write_text("a.asc",
                               "ncols 3\nnrows 2\nxllcorner 10\nyllcorner 20\ncellsize 5\nNODATA_value -9999\n"
                               "1 2 -9999\n4.5 5 6\n");
  const auto raster = read_raster(file);
  SKIP_WITHOUT_GDAL(raster);
  ASSERT_TRUE(raster) << raster.error().message;
  EXPECT_EQ(raster->height_m.rows(), 2);
  EXPECT_EQ(raster->height_m.columns(), 3);
  EXPECT_EQ(raster->x_min_m, 10.0);
  EXPECT_EQ(raster->y_min_m, 20.0);
  EXPECT_EQ(raster->cell_m, 5.0);
  EXPECT_EQ(raster->cell_y_m, 5.0);
  EXPECT_FALSE(raster->geographic);
  EXPECT_EQ(raster->height_m(0, 0), 4.5F);
  EXPECT_EQ(raster->height_m(0, 2), 6.0F);
  EXPECT_EQ(raster->height_m(1, 0), 1.0F);
  EXPECT_TRUE(std::isnan(raster->height_m(1, 2)));
}

TEST(Raster, AsciiGridWithoutNodataLineKeepsEveryValue) {
  const auto raster =
      read_raster(write_text("b.asc", "ncols 2\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 1\n0 -9999.5\n3 4\n"));
  SKIP_WITHOUT_GDAL(raster);
  ASSERT_TRUE(raster) << raster.error().message;
  EXPECT_EQ(raster->height_m(1, 0), 0.0F);
  EXPECT_EQ(raster->height_m(1, 1), -9999.5F);
}

TEST(Raster, GeoTiffReadsBackBitForBitWithOblongCellsAndHoles) {
  Raster raster;
  raster.height_m.assign(7, 4, 0.0F);
  for (std::size_t i = 0; i < raster.height_m.size(); ++i) raster.height_m[i] = 0.1F * static_cast<float>(i) - 1.0F;
  raster.height_m(3, 2) = std::numeric_limits<float>::quiet_NaN();
  raster.x_min_m = -3.025;
  raster.y_min_m = 1e6 + 0.05;
  raster.cell_m = 0.05;
  raster.cell_y_m = 0.07;
  const auto file = scratch("c.tif");
  const auto written = write_geotiff(file, raster);
  SKIP_WITHOUT_GDAL(written);
  ASSERT_TRUE(written) << written.error().message;
  const auto read = read_raster(file);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_DOUBLE_EQ(read->x_min_m, raster.x_min_m);
  EXPECT_DOUBLE_EQ(read->y_min_m, raster.y_min_m);
  EXPECT_EQ(read->cell_m, raster.cell_m);
  EXPECT_EQ(read->cell_y_m, raster.cell_y_m);
  EXPECT_FALSE(read->geographic);
  ASSERT_EQ(read->height_m.size(), raster.height_m.size());
  for (std::size_t i = 0; i < raster.height_m.size(); ++i) {
    if (std::isnan(raster.height_m[i]))
      EXPECT_TRUE(std::isnan(read->height_m[i]));
    else
      EXPECT_EQ(read->height_m[i], raster.height_m[i]);
  }
}

TEST(Raster, CoordinateSystemSurvivesACopy) {
  const auto first = scratch("crs_1.tif"), second = scratch("crs_2.tif");
  Raster raster{Grid<float>(3, 4, 1.0F), 500000.0, 4.0e6, 10.0, 10.0};
  raster.crs_wkt =
      R"(PROJCS["UTM 11",GEOGCS["WGS 84",DATUM["WGS_1984",SPHEROID["WGS 84",6378137,298.257223563]],)"
      R"(PRIMEM["Greenwich",0],UNIT["degree",0.0174532925199433]],PROJECTION["Transverse_Mercator"],)"
      R"(PARAMETER["latitude_of_origin",0],PARAMETER["central_meridian",-117],PARAMETER["scale_factor",0.9996],)"
      R"(PARAMETER["false_easting",500000],PARAMETER["false_northing",0],UNIT["metre",1]])";
  const auto written = write_geotiff(first, raster);
  SKIP_WITHOUT_GDAL(written);
  ASSERT_TRUE(written) << written.error().message;
  const auto copy = read_raster(first);
  ASSERT_TRUE(copy) << copy.error().message;
  EXPECT_NE(copy->crs_wkt.find("Transverse_Mercator"), std::string::npos) << copy->crs_wkt;
  EXPECT_FALSE(copy->geographic);
  ASSERT_TRUE(write_geotiff(second, *copy));
  EXPECT_EQ(read_raster(second)->crs_wkt, copy->crs_wkt);
}

TEST(Raster, DegreesAreToldFromMetresWithoutCrs) {
  const auto degrees = read_raster(write_text(
      "d.asc",
      "ncols 3\nnrows 2\nxllcorner -105.5\nyllcorner 40.1\ncellsize 0.000833\n2569 2573 2578\n2591 2597 2604\n"));
  SKIP_WITHOUT_GDAL(degrees);
  ASSERT_TRUE(degrees) << degrees.error().message;
  EXPECT_TRUE(degrees->geographic);
  const auto error = geographic_error(*degrees, "d.asc");
  EXPECT_EQ(error.kind, ErrorKind::bad_data);
  EXPECT_NE(error.message.find("degrees"), std::string::npos);
  EXPECT_NE(error.message.find("gdalwarp"), std::string::npos);
  // A fine metric patch near the origin is not mistaken for degrees.
  const auto metres = read_raster(write_text(
      "e.asc", "ncols 3\nnrows 2\nxllcorner -1\nyllcorner 4\ncellsize 0.01\n0.1 0.12 0.11\n0.1 0.13 0.15\n"));
  ASSERT_TRUE(metres);
  EXPECT_FALSE(metres->geographic);
}

TEST(Raster, ErrorsNameTheFile) {
  const auto missing = read_raster(scratch("none.tif"));
  SKIP_WITHOUT_GDAL(missing);
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().kind, ErrorKind::no_input);
  const auto garbage = read_raster(write_text("g.tif", "not a raster at all\n"));
  ASSERT_FALSE(garbage);
  EXPECT_EQ(garbage.error().kind, ErrorKind::bad_data);
  EXPECT_NE(garbage.error().message.find("g.tif"), std::string::npos);
  const auto empty =
      read_raster(write_text("h.asc", "ncols 2\nnrows 1\nxllcorner 0\nyllcorner 0\ncellsize 1\nNODATA_value 0\n0 0\n"));
  ASSERT_FALSE(empty);
  EXPECT_NE(empty.error().message.find("nothing but nodata"), std::string::npos) << empty.error().message;
  const auto written = write_geotiff(scratch("none/none.tif"), Raster{Grid<float>(2, 2, 1.0F)});
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().kind, ErrorKind::cannot_create);
}

TEST(RasterRealData, ElevationFilesHaveTheShapesTheirSourcesState) {
  const auto dems = test::shared_data("landlab_dems");
  SCREE_SKIP_WITHOUT(dems, "landlab_dems");
  const auto bijou = read_raster(*dems / "bijou_gully_5m.asc");  // five header lines, no NODATA
  SKIP_WITHOUT_GDAL(bijou);
  ASSERT_TRUE(bijou) << bijou.error().message;
  EXPECT_EQ(bijou->height_m.columns(), 105);
  EXPECT_EQ(bijou->height_m.rows(), 77);
  EXPECT_FALSE(bijou->geographic);
  EXPECT_NEAR(bijou->height_m(76, 0), 1726.646F, 1e-3F);  // first number of the file is the north-west cell
  const auto colorado = read_raster(*dems / "srtmgl3_colorado_front_range.asc");
  ASSERT_TRUE(colorado);
  EXPECT_TRUE(colorado->geographic);
}

TEST(RasterRealData, GeoTiffOfIntegersInUtmIsMetric) {
  const auto file = test::shared_data("bigtujunga_srtm30/srtm_bigtujunga30m_utm11.tif");
  SCREE_SKIP_WITHOUT(file, "bigtujunga_srtm30");
  const auto raster = read_raster(*file);
  SKIP_WITHOUT_GDAL(raster);
  ASSERT_TRUE(raster) << raster.error().message;
  EXPECT_FALSE(raster->geographic);
  EXPECT_EQ(raster->height_m.columns(), 1197);
  EXPECT_EQ(raster->height_m.rows(), 643);
  EXPECT_NEAR(raster->cell_m, 30.0, 1e-6);
  float low = 1e9F, high = -1e9F;
  for (const float z : raster->height_m) {
    ASSERT_FALSE(std::isnan(z));
    low = std::min(low, z);
    high = std::max(high, z);
  }
  EXPECT_EQ(low, 315.0F);
  EXPECT_EQ(high, 2295.0F);
}

TEST(RasterRealData, OblongCellsAreKeptOblong) {
  const auto file = test::shared_data("matplotlib_dems/jacksboro_fault_dem.asc");
  SCREE_SKIP_WITHOUT(file, "matplotlib_dems");
  const auto raster = read_raster(*file);
  SKIP_WITHOUT_GDAL(raster);
  ASSERT_TRUE(raster) << raster.error().message;
  EXPECT_NEAR(raster->cell_m, 74.4, 0.1);
  EXPECT_NEAR(raster->cell_y_m, 92.5, 0.1);
}

}  // namespace
}  // namespace scree::io
