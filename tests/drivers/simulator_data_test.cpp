// The simulated scanner over real terrain.

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <map>

#include "drivers/terrain_load.hpp"
#include "io/point_cloud.hpp"
#include "tests/drivers/simulator_support.hpp"
#include "tests/support/shared_data.hpp"

namespace scree::drivers {
namespace {

constexpr const char* kSurvey = "pdal_lonestar_tls/lone-star_local_xyzi.bin";

#define SKIP_WITHOUT_LIBRARY(result) \
  if (!(result) && (result).error().kind == ErrorKind::unavailable) GTEST_SKIP() << (result).error().message

class SurveyDrive : public testing::TestWithParam<const char*> {};

// Open ground towards a group of trees; the noiseless frames must lie on the surface as exactly as on any other.
TEST_P(SurveyDrive, NoiselessFramesLieOnTheSurveyedSurface) {
  const auto file = test::shared_data(kSurvey);
  SCREE_SKIP_WITHOUT(file, kSurvey);
  SimulatorConfig config;
  config.terrain = file->string();
  config.sensor = GetParam();
  config.trajectory = "arc:18,36,-10,20,15,1.5";
  config.noise = false;
  const auto simulator = made(config);
  EXPECT_DOUBLE_EQ(simulator.terrain().raster().cell_m, 0.1);
  SerialExecutor serial;
  for (const std::size_t i : {std::size_t{0}, simulator.frame_count() - 1}) {
    const auto frame = simulator.render(i, serial);
    ASSERT_TRUE(frame);
    const Agreement agreement = compare(simulator, *frame);
    EXPECT_GT(agreement.returns, frame->raw.size() / 2);
    EXPECT_LE(agreement.worst_counts, 0.5 + 2e-3);
    EXPECT_LE(agreement.worst_surface_m, 1e-4);  // trunks are nearly vertical: a micrometre along the ray is more in z
  }
}

// Where the sensor's central rays meet open ground the declared noise holds: the median of |error| / sigma is 0.67 for
// a normal error of that size, less on ground that is met more steeply than level ground, more on grazed one.
TEST_P(SurveyDrive, NominalFramesScatterAboutTheSurfaceAsDeclared) {
  const auto file = test::shared_data(kSurvey);
  SCREE_SKIP_WITHOUT(file, kSurvey);
  SimulatorConfig config;
  config.terrain = file->string();
  config.sensor = GetParam();
  config.trajectory = "line:18,36,0,6,1.5";
  const auto simulator = made(config);
  const SensorConfig& sensor = simulator.description().sensor;
  SerialExecutor serial;
  const auto frame = simulator.render(1, serial);
  ASSERT_TRUE(frame);
  std::vector<double> normalised;
  std::size_t without_surface = 0;
  for (int r = 0; r < frame->raw.rows(); ++r)
    for (int c = 0; c < frame->raw.columns(); ++c) {
      if (frame->raw(r, c) == 0) continue;
      const double truth = frame->true_range_m(r, c);
      without_surface += std::isnan(truth);
      if (!(truth < sensor.filter.range_max_m)) continue;
      const PixelRay ray = pixel_ray(sensor.projection, r, c);
      const double error = std::remainder(ray.range_offset_m + frame->raw(r, c) * ray.range_per_count_m - truth,
                                          sensor.projection.ambiguity_m);
      const double sigma =
          std::hypot(sensor.noise.sigma_m, sensor.noise.sigma_per_m * truth,
                     std::hypot(sensor.noise.sigma_per_m2 * truth * truth, ray.range_per_count_m / 3.46));
      normalised.push_back(std::abs(error) / sigma);
    }
  ASSERT_GT(normalised.size(), frame->raw.size() / 2);
  const auto middle = normalised.begin() + static_cast<std::ptrdiff_t>(normalised.size() / 2);
  std::nth_element(normalised.begin(), middle, normalised.end());
  RecordProperty("median_normalised_error", std::to_string(*middle));
  EXPECT_GT(*middle, 0.3);
  EXPECT_LT(*middle, 1.0);
  EXPECT_LT(without_surface, frame->raw.size() / 20);  // edges of holes only
}

INSTANTIATE_TEST_SUITE_P(Simulator, SurveyDrive, testing::Values("perceptron-usf", "perceptron-cmu"),
                         [](const auto& sensor) {
                           std::string name = sensor.param;
                           std::erase(name, '-');
                           return name;
                         });

TEST(SurveyTerrain, NodesAreTheSurveysOwnMeansWhereItIsFlat) {
  const auto file = test::shared_data(kSurvey);
  SCREE_SKIP_WITHOUT(file, kSurvey);
  const auto terrain = load_terrain(file->string());
  ASSERT_TRUE(terrain) << terrain.error().message;
  const auto cloud = io::read_point_cloud(*file);
  ASSERT_TRUE(cloud);
  const double cell = terrain->raster().cell_m;
  std::map<std::pair<int, int>, std::vector<float>> cells;
  for (const auto& p : cloud->points)
    cells[{static_cast<int>(std::floor(p.y() / cell)), static_cast<int>(std::floor(p.x() / cell))}].push_back(p.z());
  const int first_row = static_cast<int>(std::lround(terrain->raster().y_min_m / cell));
  const int first_column = static_cast<int>(std::lround(terrain->raster().x_min_m / cell));
  std::size_t flat = 0, steep = 0;
  for (const auto& [place, heights] : cells) {
    const auto [low, high] = std::minmax_element(heights.begin(), heights.end());
    double mean = 0.0;
    for (const float z : heights) mean += z / static_cast<double>(heights.size());
    const float node = terrain->raster().height_m(place.first - first_row, place.second - first_column);
    const bool is_flat = *high - *low < 0.2F;
    (is_flat ? flat : steep)++;
    EXPECT_NEAR(node, is_flat ? mean : *high, 1e-5);
  }
  std::size_t finite = 0;
  for (const float z : terrain->raster().height_m) finite += std::isfinite(z);
  EXPECT_EQ(finite, cells.size());  // nothing invented
  EXPECT_GT(flat, 30000U);
  EXPECT_GT(steep, 10000U);
}

class DemDrive : public testing::TestWithParam<const char*> {};

TEST_P(DemDrive, NoiselessFramesLieOnTheElevationModel) {
  const auto file = test::shared_data(GetParam());
  SCREE_SKIP_WITHOUT(file, GetParam());
  const auto terrain = load_terrain(file->string());
  SKIP_WITHOUT_LIBRARY(terrain);
  ASSERT_TRUE(terrain) << terrain.error().message;
  SimulatorConfig config;
  config.terrain = file->string();
  config.sensor = "perceptron-cmu";
  config.trajectory = fmt::format("line:{},{},60,2,2", 0.5 * (terrain->x_min_m() + terrain->x_max_m()),
                                  0.5 * (terrain->y_min_m() + terrain->y_max_m()));
  config.noise = false;
  const auto simulator = made(config);
  SerialExecutor serial;
  const auto frame = simulator.render(0, serial);
  ASSERT_TRUE(frame);
  const Agreement agreement = compare(simulator, *frame);
  EXPECT_GT(agreement.returns, frame->raw.size() / 3);
  EXPECT_LE(agreement.worst_counts, 0.5 + 2e-3);
  EXPECT_LE(agreement.worst_surface_m, 1e-4);
}

INSTANTIATE_TEST_SUITE_P(Simulator, DemDrive,
                         testing::Values("landlab_dems/bijou_gully_5m.asc", "landlab_dems/pre_runout_10m.asc",
                                         "bigtujunga_srtm30/srtm_bigtujunga30m_utm11.tif",
                                         "matplotlib_dems/jacksboro_fault_dem.asc"),
                         [](const auto& dem) {
                           std::string name = std::filesystem::path(dem.param).stem();
                           return name;
                         });

TEST(DemTerrain, CellsInDegreesAreRefusedWithTheWayOut) {
  const char* dem = "landlab_dems/srtmgl3_colorado_front_range.asc";
  const auto file = test::shared_data(dem);
  SCREE_SKIP_WITHOUT(file, dem);
  const auto terrain = load_terrain(file->string());
  SKIP_WITHOUT_LIBRARY(terrain);
  ASSERT_FALSE(terrain);
  EXPECT_EQ(terrain.error().kind, ErrorKind::bad_data);
  EXPECT_NE(terrain.error().message.find("degrees"), std::string::npos) << terrain.error().message;
  EXPECT_NE(terrain.error().message.find("gdalwarp"), std::string::npos);
}

}  // namespace
}  // namespace scree::drivers
