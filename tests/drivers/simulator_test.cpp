#include "drivers/simulator.hpp"

#include <cmath>
#include <fstream>
#include <functional>
#include <gtest/gtest.h>
#include <thread>

#include "drivers/frame/point_frame.hpp"
#include "drivers/simulator_scan.hpp"
#include "io/npy.hpp"
#include "tests/drivers/simulator_support.hpp"

namespace scree::drivers {
namespace {

using Eigen::Vector3d;

/// Two threads with an uneven cut, to be told from one.
class TwoThreads final : public Executor {
 public:
  void for_ranges(int count, const std::function<void(int, int)>& body) override {
    std::jthread other([&] { body(count / 3, count); });
    body(0, count / 3);
  }
};

class EverySensor : public testing::TestWithParam<const char*> {};

// True ranges are stored as float: 2^-24 of up to 40 m, and 10 µm leaves room for steep ground under a moved point.
TEST_P(EverySensor, WithoutNoiseGivesTheTerrainBackToHalfACountWhileMovingAndTurning) {
  const auto simulator = made(small_drive(GetParam(), false));
  SerialExecutor serial;
  ASSERT_GE(simulator.frame_count(), 3U);
  for (const std::size_t i : {std::size_t{0}, simulator.frame_count() / 2, simulator.frame_count() - 1}) {
    const auto frame = simulator.render(i, serial);
    ASSERT_TRUE(frame);
    const Agreement agreement = compare(simulator, *frame);
    EXPECT_GT(agreement.returns, frame->raw.size() / 4) << GetParam();
    EXPECT_LE(agreement.worst_counts, 0.5 + 2e-3);
    EXPECT_LE(agreement.worst_surface_m, 1e-5);
    EXPECT_LE(static_cast<double>(agreement.next_to_invalid), 0.002 * static_cast<double>(agreement.returns));
  }
}

TEST_P(EverySensor, NoisyFramesDependOnSeedAndFrameOnly) {
  const auto simulator = made(small_drive(GetParam(), true));
  auto other_seed = small_drive(GetParam(), true);
  other_seed.seed = 6;
  const auto reseeded = made(other_seed);
  SerialExecutor serial;
  TwoThreads threads;
  const auto late = simulator.render(2, serial), early = simulator.render(0, serial);
  const auto again = simulator.render(2, threads);
  ASSERT_TRUE(late && early && again);
  EXPECT_EQ(late->raw, again->raw);
  EXPECT_EQ(late->reflectance, again->reflectance);
  EXPECT_NE(late->raw, early->raw);
  EXPECT_NE(late->raw, reseeded.render(2, serial)->raw);
}

// The mean of (error / declared sigma)² over level ground is what the declaration promises to be 1. n > 5,000 pixels;
// texture cells and the drift's phase leave it a few per cent of its own: 0.8 … 1.25.
TEST_P(EverySensor, DeclaredNoiseIsTheMeasuredOneOnLevelGround) {
  std::ofstream(scratch("level.asc"))
      << "ncols 2\nnrows 2\nxllcorner -2000\nyllcorner -2000\ncellsize 2000\n0 0\n0 0\n";
  SimulatorConfig config = small_drive(GetParam(), true);
  config.terrain = scratch("level.asc").string();
  config.trajectory = "line:-20,0,0,30,1";  // a drift period of drive
  const auto made_simulator = Simulator::make(config);
  if (!made_simulator && made_simulator.error().kind == ErrorKind::unavailable) GTEST_SKIP() << "a build without GDAL";
  ASSERT_TRUE(made_simulator) << made_simulator.error().message;
  const auto& simulator = *made_simulator;
  const SensorConfig& sensor = simulator.description().sensor;
  SerialExecutor serial;
  double sum = 0.0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < simulator.frame_count(); i += simulator.frame_count() / 6) {
    const auto frame = simulator.render(i, serial);
    ASSERT_TRUE(frame);
    for (int r = 0; r < frame->raw.rows(); ++r)
      for (int c = 0; c < frame->raw.columns(); ++c) {
        const double truth = frame->true_range_m(r, c);
        if (frame->raw(r, c) == 0 || !(truth <= sensor.filter.range_max_m)) continue;
        const PixelRay ray = pixel_ray(sensor.projection, r, c);
        double error = ray.range_offset_m + frame->raw(r, c) * ray.range_per_count_m - truth;
        if (sensor.projection.ambiguity_m > 0.0) error = std::remainder(error, sensor.projection.ambiguity_m);
        const double a = sensor.noise.sigma_m, b = sensor.noise.sigma_per_m * truth,
                     d = sensor.noise.sigma_per_m2 * truth * truth, q = ray.range_per_count_m;
        sum += error * error / (a * a + b * b + d * d + q * q / 12.0);
        ++count;
      }
  }
  ASSERT_GT(count, 5000U);
  RecordProperty("variance_ratio", std::to_string(sum / static_cast<double>(count)));
  EXPECT_GT(sum / static_cast<double>(count), 0.8) << GetParam();
  EXPECT_LT(sum / static_cast<double>(count), 1.25) << GetParam();
}

INSTANTIATE_TEST_SUITE_P(Simulator, EverySensor,
                         testing::Values("perceptron-usf", "perceptron-cmu", "lidar64", "depth", "depth-small"),
                         [](const auto& sensor) {
                           std::string name = sensor.param;
                           std::erase(name, '-');
                           return name;
                         });

// The way that the map takes: phases resolved against the ground, per-row poses, float points. 0.5 counts of 9.8 mm and
// 50 µm for float tables and coordinates.
TEST(Simulator, PointConverterPutsNoiselessFramesBackOntoTheTerrain) {
  const auto simulator = made(small_drive("perceptron-cmu", false));
  const GroundLookup ground = [&](double x, double y) -> std::optional<GroundHeight> {
    const double z = simulator.terrain().height_m(x, y);
    if (std::isnan(z)) return std::nullopt;
    return GroundHeight{z, 0.01};
  };
  SerialExecutor serial;
  PointConverter converter;
  PointFrame points;
  const auto frame = simulator.render(3, serial);
  ASSERT_TRUE(frame);
  ASSERT_TRUE(converter.convert(*simulator.range_frame(*frame, Duration{0}), ground, serial, points));
  EXPECT_GT(points.size(), frame->raw.size() / 2);
  std::size_t jumped = 0;
  for (std::size_t row = 0; row + 1 < points.row_begin.size(); ++row)
    for (std::size_t i = points.row_begin[row]; i < points.row_begin[row + 1]; ++i) {
      const Vector3d sensor = points.sensor_m[row].cast<double>() + points.anchor_map_m;
      const Vector3d point = Vector3d(points.x_m[i], points.y_m[i], points.z_m[i]) + points.anchor_map_m;
      const double distance = (point - sensor).norm();
      const auto hit = simulator.terrain().cast(sensor, (point - sensor) / distance, 100.0);
      ASSERT_EQ(hit.kind, TerrainHit::Kind::surface);
      // A float direction off by 1e-7 may jump over a crest; those few are seen as distances beyond it.
      if (std::abs(hit.distance_m - distance) > 0.05)
        ++jumped;
      else
        EXPECT_NEAR(hit.distance_m, distance, 0.5 * 40.0 / 4096.0 + 5e-5);
    }
  EXPECT_LT(jumped, points.size() / 10000);
}

TEST(Simulator, DescribesItsRecordingAsTheFormatWantsIt) {
  for (const char* name : {"perceptron-usf", "perceptron-cmu", "lidar64", "depth", "depth-small"}) {
    const auto simulator = made(small_drive(name, true));
    const auto& description = simulator.description();
    EXPECT_EQ(description.origin, Origin::sim);
    EXPECT_EQ(description.sensor.projection.invalid_raw, 0);
    EXPECT_EQ(description.sensor.projection.trusted_rows, description.sensor.projection.rows);
    EXPECT_GT(description.sensor.noise.sigma_m + description.sensor.noise.sigma_per_m2, 0.0);
    EXPECT_LT(description.sensor.filter.range_min_m, description.sensor.filter.range_max_m);
  }
  EXPECT_EQ(made(small_drive("perceptron-usf", false)).description().sensor.noise.sigma_m, 0.0);
  EXPECT_EQ(made(small_drive("perceptron-usf", false)).description().sensor.row_period, Duration(976562));
}

TEST(Simulator, FramesFillTheDrive) {
  auto config = small_drive("perceptron-cmu", false);
  config.trajectory = "line:-5,0,0,4,1";  // 4 s, a frame each half second, the last one while standing
  EXPECT_EQ(made(config).frame_count(), 9U);
  config.frame_period = std::chrono::seconds(1);
  const auto simulator = made(config);
  EXPECT_EQ(simulator.frame_count(), 5U);
  EXPECT_EQ(simulator.frame_time(3), Time(std::chrono::seconds(3)));
  SerialExecutor serial;
  EXPECT_FALSE(simulator.render(5, serial));
}

TEST(Simulator, RaysOverTheEdgeOfTheWorldMeetNothing) {
  auto config = small_drive("perceptron-cmu", true);
  config.trajectory = "line:10,0,0,0,1";  // looks over the border at x = 12
  SerialExecutor serial;
  const auto frame = made(config).render(0, serial);
  ASSERT_TRUE(frame);
  std::size_t nothing = 0;
  for (std::size_t i = 0; i < frame->raw.size(); ++i)
    if (std::isnan(frame->true_range_m[i]) && frame->raw[i] == 0) ++nothing;
  EXPECT_GT(nothing, frame->raw.size() / 3);
}

TEST(Simulator, UsageErrorsNameWhatIsExpected) {
  const auto expect = [](SimulatorConfig config, ErrorKind kind, const std::string& text) {
    const auto simulator = Simulator::make(config);
    ASSERT_FALSE(simulator) << text;
    EXPECT_EQ(simulator.error().kind, kind) << simulator.error().message;
    EXPECT_NE(simulator.error().message.find(text), std::string::npos) << simulator.error().message;
  };
  const auto with = [](auto member, const std::string& value) {
    auto config = small_drive("perceptron-cmu", true);
    config.*member = value;
    return config;
  };
  expect(with(&SimulatorConfig::sensor, "sonar"), ErrorKind::usage,
         "perceptron-usf | perceptron-cmu | lidar64 | depth | depth-small");
  expect(with(&SimulatorConfig::terrain, "fbm:2.3,0.1"), ErrorKind::usage, "fbm:D,AMPLITUDE_M,SEED");
  expect(with(&SimulatorConfig::terrain, "fbm:3.3,0.1,1"), ErrorKind::usage, "D must be between 2 and 3");
  expect(with(&SimulatorConfig::terrain, "fbm:2.3,0.1,1.5"), ErrorKind::usage, "seed");
  expect(with(&SimulatorConfig::terrain, "fbm:2.3,0.1,1,1e6,0.01"), ErrorKind::usage, "EXTENT_M / CELL_M");
  expect(with(&SimulatorConfig::terrain, ""), ErrorKind::usage, "--terrain");
  expect(with(&SimulatorConfig::terrain, "/nonexistent/points.bin"), ErrorKind::no_input, "/nonexistent/points.bin");
  expect(with(&SimulatorConfig::trajectory, "line:1"), ErrorKind::usage, "line:X0,Y0,HEADING_DEG,LENGTH_M,SPEED_MPS");
  expect(with(&SimulatorConfig::trajectory, "line:0,0,0,40,1"), ErrorKind::usage, "x -11.95 … 11.95 m");
  auto hurried = small_drive("perceptron-cmu", true);
  hurried.frame_period = std::chrono::milliseconds(100);
  expect(hurried, ErrorKind::usage, "frame period");
}

TEST(SurveyGridding, MeansWhereFlatTopsWhereNotAndHolesWhereEmpty) {
  std::vector<Eigen::Vector4f> points;
  const auto add = [&](double x, double y, double z) {
    points.emplace_back(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z), 0.0F);
  };
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 5; ++column) {
      if (row == 2 && column == 2) continue;
      add(column + 0.25, row + 0.5, 0.0);
      add(column + 0.75, row + 0.5, row == 0 && column == 4 ? 3.0 : 0.125);
    }
  SurveyGridding gridding;
  gridding.cell_m = 1.0;
  const auto raster = grid_survey(points, {100.0, -50.0, 7.0}, gridding, "survey");
  ASSERT_TRUE(raster);
  EXPECT_EQ(raster->x_min_m, 100.0);
  EXPECT_EQ(raster->y_min_m, -50.0);
  EXPECT_EQ(raster->height_m.rows(), 4);
  EXPECT_EQ(raster->height_m.columns(), 5);
  EXPECT_EQ(raster->height_m(1, 1), 7.0625F);
  EXPECT_EQ(raster->height_m(0, 4), 10.0F);
  EXPECT_TRUE(std::isnan(raster->height_m(2, 2)));
}

TEST(SurveyGridding, CellHoldsAboutFourPoints) {
  std::vector<Eigen::Vector4f> points;  // 400 points a square metre: 0.1 m
  for (int i = 0; i < 200; ++i)
    for (int j = 0; j < 200; ++j)
      points.emplace_back(0.05F * static_cast<float>(i), 0.05F * static_cast<float>(j), 0.0F, 0.0F);
  EXPECT_DOUBLE_EQ(survey_cell_m(points), 0.1);
}

TEST(RecordCount, NeverSaysNothingForSomething) {
  const PixelRay ray{Vector3d::Zero(), Vector3d::UnitZ(), 1.0, 0.01};
  EXPECT_EQ(record_count(ray, 1.0, true), 1);
  EXPECT_EQ(record_count(ray, 0.998, true), 4095);
  EXPECT_EQ(record_count(ray, 1.0 + 4096 * 0.01 + 0.021, true), 2);
  EXPECT_EQ(record_count(ray, 0.9, false), 1);
  EXPECT_EQ(record_count(ray, 1.0 + 655.35, false), 65535);
  EXPECT_EQ(record_count(ray, 1.0 + 655.36, false), 0);
}

TEST(SimulatedSource, DeliversWhatWasRenderedAndEnds) {
  auto config = small_drive("perceptron-cmu", true);
  config.frame_period = std::chrono::seconds(2);
  auto source = simulated_source(config, false);
  ASSERT_TRUE(source) << source.error().message;
  const auto simulator = made(config);
  EXPECT_EQ((*source)->origin(), Origin::sim);
  SerialExecutor serial;
  for (std::size_t i = 0; i < simulator.frame_count(); ++i) {
    const auto event = (*source)->next(std::chrono::milliseconds(0));
    ASSERT_TRUE(event);
    ASSERT_EQ(event->kind, SourceEvent::Kind::frame);
    const RangeFrame& frame = *event->frame;
    const auto rendered = simulator.render(i, serial);
    EXPECT_EQ(frame.sequence, i);
    EXPECT_EQ(frame.time, simulator.frame_time(i));
    EXPECT_EQ(frame.row_time.back(), frame.time + 255 * simulator.description().sensor.row_period);
    EXPECT_EQ(frame.T_map_body.back().translation_m, simulator.poses().at(frame.row_time.back())->translation_m);
    for (std::size_t p = 0; p < rendered->raw.size(); ++p) {
      if (rendered->raw[p] == 0)
        ASSERT_TRUE(std::isnan(frame.range_m[p]));
      else
        ASSERT_FLOAT_EQ(frame.range_m[p], static_cast<float>(rendered->raw[p] * 40.0 / 4096.0));
    }
  }
  const auto end = (*source)->next(std::chrono::milliseconds(0));
  ASSERT_TRUE(end);
  EXPECT_EQ(end->kind, SourceEvent::Kind::end_of_stream);
}

TEST(SimulatedSource, RealTimeWaitsForTheLastRowAndCountsWhatItSkips) {
  auto config = small_drive("perceptron-cmu", false);
  config.trajectory = "line:-5,0,0,1.5,1";  // due after 0.5, 1.0, 1.5 and 2 s
  auto source = simulated_source(config, true);
  ASSERT_TRUE(source);
  const auto early = (*source)->next(std::chrono::milliseconds(1));
  ASSERT_TRUE(early);
  EXPECT_EQ(early->kind, SourceEvent::Kind::timeout);
  std::this_thread::sleep_for(std::chrono::milliseconds(1100));  // past the second frame
  const auto skipped = (*source)->next(std::chrono::milliseconds(0));
  ASSERT_TRUE(skipped);
  EXPECT_EQ(skipped->kind, SourceEvent::Kind::skipped);
  const auto newest = (*source)->next(std::chrono::milliseconds(0));
  ASSERT_TRUE(newest);
  ASSERT_EQ(newest->kind, SourceEvent::Kind::frame);
  EXPECT_GE(newest->frame->sequence, 1U);
  const auto age = std::chrono::system_clock::now() - newest->frame->time;
  EXPECT_GT(age, std::chrono::milliseconds(498));  // stamped with its first row on the wall clock
  EXPECT_LT(age, std::chrono::seconds(10));
}

TEST(SimulatedRecording, HoldsFramesPosesAndTruth) {
  auto config = small_drive("depth", true);
  config.frame_period = std::chrono::seconds(2);
  const auto simulator = made(config);
  SerialExecutor serial;
  std::size_t reported = 0;
  const auto folder = scratch("recording");
  const auto written = write_recording(simulator, folder, "scree_recording: 1\n", serial,
                                       [&](std::size_t done, std::size_t) { reported = done; });
  ASSERT_TRUE(written) << written.error().message;
  EXPECT_EQ(reported, simulator.frame_count());
  auto source = open_recording(folder, simulator.description(), {});
  ASSERT_TRUE(source) << source.error().message;
  for (std::size_t i = 0; i < simulator.frame_count(); ++i) {
    const auto event = (*source)->next(std::chrono::milliseconds(100));
    ASSERT_TRUE(event && event->kind == SourceEvent::Kind::frame) << i;
    const auto direct = simulator.range_frame(*simulator.render(i, serial), Duration{0});
    for (std::size_t p = 0; p < direct->range_m.size(); ++p) {
      if (std::isnan(direct->range_m[p]))
        ASSERT_TRUE(std::isnan(event->frame->range_m[p]));
      else
        ASSERT_EQ(event->frame->range_m[p], direct->range_m[p]);
    }
    for (std::size_t r = 0; r < direct->T_map_body.size(); ++r)
      ASSERT_NEAR((direct->T_map_body[r].translation_m - event->frame->T_map_body[r].translation_m).norm(), 0.0, 1e-12);
  }
  const auto truth = io::read_npy(folder / "truth/000000.range.npy");
  ASSERT_TRUE(truth);
  EXPECT_EQ(truth->rows(), 480);
  const auto terrain = io::read_raster(folder / "truth/terrain.tif");
  if (terrain) {
    EXPECT_EQ(terrain->height_m, simulator.terrain().raster().height_m);
  }
}

}  // namespace
}  // namespace scree::drivers
