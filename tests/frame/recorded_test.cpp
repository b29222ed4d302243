// Recorded frames and the synthetic USF file, where they lie beside this checkout.

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <gtest/gtest.h>
#include <iterator>
#include <vector>

#include "tests/frame/scanned_scene.hpp"
#include "tests/support/shared_data.hpp"

namespace scree {
namespace {

using namespace test;

std::vector<unsigned char> bytes_of(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

RangeFrame frame_of(std::shared_ptr<const Projection> projection, const SensorConfig& sensor, Grid<float> range_m) {
  RangeFrame frame;
  frame.sensor = std::make_shared<const SensorConfig>(sensor);
  frame.row_time.assign(static_cast<std::size_t>(projection->rows), Time{});
  frame.T_map_body.assign(static_cast<std::size_t>(projection->rows), Pose{});
  frame.range_m = std::move(range_m);
  frame.projection = std::move(projection);
  return frame;
}

/// Error along the ray of the points in one band of true distance.
struct Band {
  double below_m;
  double claimed_sd_m;  ///< of the file's own description, before any filter
  double n = 0, sum = 0, sum2 = 0;

  void add(double error) {
    n += 1;
    sum += error;
    sum2 += error * error;
  }
  double sd() const { return std::sqrt(sum2 / n - (sum / n) * (sum / n)); }
};

struct UsfFile {
  Grid<float> range_m, truth_m;  ///< truth 0 = sky
};

UsfFile read_usf(const Projection& p, const std::filesystem::path& perc, const std::filesystem::path& truth) {
  const auto bytes = bytes_of(perc);
  const auto exact = bytes_of(truth);
  constexpr std::size_t kPixels = 512 * 512;
  UsfFile file{Grid<float>(512, 512), Grid<float>(512, 512)};
  EXPECT_GE(bytes.size(), 4 * kPixels);
  EXPECT_EQ(exact.size(), 4 * kPixels);
  const unsigned char* word = bytes.data() + bytes.size() - 4 * kPixels;
  for (std::size_t i = 0; i < kPixels; ++i, word += 4) {
    const int raw = (word[2] << 8 | word[3]) & 0xfff;
    file.range_m[i] = p.range_offset_m[i] + static_cast<float>(raw) * p.range_per_count_m[i];
    float truth_cm = 0.0F;
    std::memcpy(&truth_cm, exact.data() + 4 * i, 4);
    file.truth_m[i] = truth_cm * 0.01F;
  }
  return file;
}

// The file describes itself: error sd 0.21 / 0.39 / 0.89 cm below 3 m, at 3–6 m and above, 10.5 % sky with random
// ranges. The filters may only improve on the sd (5 % allowed for the choice of pixels). Sky: inside it nothing can
// survive (no cores in noise, tests/frame/filter_test.cpp); along the horizon a random pixel needs a horizontal
// neighbour that fits as well, p² ≈ (2 · 0.2 / 8.3)² of about 1000 rim pixels a step: some ten pixels, 0.05 % of the
// sky, which then lie within the join tolerance of the ridge beside them.
TEST(SyntheticUsfFile, AgreesWithItsTruthAndItsSkyIsNotGround) {
  const auto perc = shared_data("perceptron_SYNTHETIC/synthetic_msh.perc");
  const auto truth = shared_data("perceptron_SYNTHETIC/synthetic_msh.truth_t_cm.f32");
  SCREE_SKIP_WITHOUT(perc, "perceptron_SYNTHETIC/synthetic_msh.perc");
  const auto projection = projection_of(ProjectionKind::perceptron_usf, 512, 512);
  const UsfFile file = read_usf(*projection, *perc, *truth);
  SensorConfig sensor;
  sensor.T_body_sensor = perceptron_mount(2.1, 32.0 * 3.14159265 / 180.0);
  sensor.noise = {0.002, 0.0, 0.0002};
  for (const auto policy : {PhasePolicy::resolve, PhasePolicy::first_interval}) {
    sensor.filter.phase = policy;
    if (policy == PhasePolicy::first_interval) sensor.T_body_sensor = perceptron_mount(0.0, 0.0);  // nothing known
    const RangeFrame frame = frame_of(projection, sensor, file.range_m);
    SerialExecutor executor;
    PointFrame points;
    ASSERT_TRUE(PointConverter().convert(frame, {}, executor, points));
    EXPECT_EQ(accounted(points.counts), points.counts.pixels);

    Band bands[] = {{3.0, 0.0021}, {6.0, 0.0039}, {1e3, 0.0089}};
    std::size_t sky = 0, sky_points = 0, off = 0;
    for (int r = 0; r < 508; ++r) {
      std::uint32_t i = points.row_begin[static_cast<std::size_t>(r)];
      for (int c = 0; c < 512; ++c) {
        const double exact = file.truth_m(r, c);
        sky += exact == 0.0 ? 1U : 0U;
        if (i == points.row_begin[static_cast<std::size_t>(r) + 1] || points.range_m[i] != file.range_m(r, c)) continue;
        const double error = points.range_m[i++] - exact;
        sky_points += exact == 0.0 ? 1U : 0U;
        if (exact == 0.0) continue;
        off += std::abs(error) > 0.1 ? 1U : 0U;
        std::find_if(std::begin(bands), std::end(bands), [&](const Band& b) { return exact < b.below_m; })->add(error);
      }
    }
    std::printf("policy %d: sd %.2f %.2f %.2f cm of %.0f %.0f %.0f points; sky %zu of %zu; off %zu\n",
                static_cast<int>(policy), 100 * bands[0].sd(), 100 * bands[1].sd(), 100 * bands[2].sd(), bands[0].n,
                bands[1].n, bands[2].n, sky_points, sky, off);
    const auto& n = points.counts;
    std::printf("  points %d speckle %d mixed %d ambiguous %d wrapped %d assumed %d\n", static_cast<int>(n.points),
                static_cast<int>(n.speckle), static_cast<int>(n.mixed), static_cast<int>(n.ambiguous),
                static_cast<int>(n.wrapped), static_cast<int>(n.assumed_first_interval));
    for (const Band& band : bands) EXPECT_LE(band.sd(), 1.05 * band.claimed_sd_m);
    EXPECT_LT(sky_points, sky / 1000);
    EXPECT_EQ(off, 0U);
  }
}

/// 16-bit big-endian PGM.
Grid<float> read_depth(const std::filesystem::path& file, int& rows, int& columns) {
  const auto bytes = bytes_of(file);
  const std::string head(bytes.begin(), bytes.begin() + 64);
  int maximum = 0;
  EXPECT_EQ(std::sscanf(head.c_str(), "P5 %d %d %d", &columns, &rows, &maximum), 3);
  Grid<float> raw(rows, columns);
  const unsigned char* sample = bytes.data() + bytes.size() - 2 * raw.size();
  for (std::size_t i = 0; i < raw.size(); ++i, sample += 2) raw[i] = static_cast<float>(sample[0] << 8 | sample[1]);
  return raw;
}

struct DepthFile {
  const char* name;
  double fx, fy, cx, cy;
  double noise_per_m2;
  double rejected_at_most;  ///< share of the valid returns
};

// No truth here: the share that the filters reject is a sanity bound. Structured light loses flecks at every edge, and
// its quantum grows with the square of the depth (about 2.8 mm at 1 m, [KE12]).
TEST(RecordedDepth, MostOfTheReturnsSurviveTheFilters) {
  const DepthFile files[] = {
      {"rgbd_kinect_slambook2/depth_1.pgm", 518.0, 519.0, 325.5, 253.5, 0.002, 0.05},
      {"rgbd_kinect_slambook2/depth_2.pgm", 518.0, 519.0, 325.5, 253.5, 0.002, 0.05},
      {"rgbd_kinect_slambook2/depth_3.pgm", 518.0, 519.0, 325.5, 253.5, 0.002, 0.05},
      {"rgbd_kinect_slambook2/depth_4.pgm", 518.0, 519.0, 325.5, 253.5, 0.002, 0.05},
      {"rgbd_kinect_slambook2/depth_5.pgm", 518.0, 519.0, 325.5, 253.5, 0.002, 0.05},
      {"realsense_d435_bag/one_cloud_depth_z16_848x480.pgm", 424.0653, 424.0653, 423.9442, 240.8047, 0.003, 0.1},
      {"realsense_d435_bag/hand_depth_z16_848x480.pgm", 424.0653, 424.0653, 423.9442, 240.8047, 0.003, 0.1},
  };
  PointConverter converter;
  for (const DepthFile& depth : files) {
    const auto path = shared_data(depth.name);
    SCREE_SKIP_WITHOUT(path, depth.name);
    int rows = 0, columns = 0;
    const Grid<float> raw = read_depth(*path, rows, columns);
    ProjectionConfig config;
    config.kind = ProjectionKind::pinhole;
    config.fx_px = depth.fx;
    config.fy_px = depth.fy;
    config.cx_px = depth.cx;
    config.cy_px = depth.cy;
    const auto projection = *make_projection(config, rows, columns);
    Grid<float> range_m(rows, columns);
    for (std::size_t i = 0; i < raw.size(); ++i)
      range_m[i] = raw[i] == 0.0F ? std::nanf("") : raw[i] * projection->range_per_count_m[i];
    SensorConfig sensor;
    sensor.noise = {0.002, 0.0, depth.noise_per_m2};
    const RangeFrame frame = frame_of(projection, sensor, std::move(range_m));
    SerialExecutor executor;
    PointFrame points;
    ASSERT_TRUE(converter.convert(frame, {}, executor, points));
    EXPECT_EQ(accounted(points.counts), points.counts.pixels);
    const auto valid = static_cast<double>(points.counts.pixels - points.counts.no_return);
    const double rejected = static_cast<double>(points.counts.speckle + points.counts.mixed) / valid;
    std::printf("%s: valid %.1f %%, mixed %.2f %%, speckle %.2f %% of the valid\n", depth.name,
                100.0 * valid / static_cast<double>(points.counts.pixels),
                100.0 * static_cast<double>(points.counts.mixed) / valid,
                100.0 * static_cast<double>(points.counts.speckle) / valid);
    EXPECT_LT(rejected, depth.rejected_at_most) << depth.name;
  }
}

}  // namespace
}  // namespace scree
