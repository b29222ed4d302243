#include <array>
#include <cmath>

#include "drivers/perceptron_file.hpp"
#include "tests/drivers/recording_fixture.hpp"
#include "tests/support/shared_data.hpp"

namespace scree::drivers {
namespace {

TEST_F(RecordingTest, SingleFileStandsAtTheOriginWithRep103Axes) {
  RangeFile file;
  file.raw.assign(3, 4, 100);
  const auto bytes = encode_range_file(file);
  ASSERT_TRUE(bytes);
  write("x.perc", std::string(bytes->begin(), bytes->end()));
  const auto source = open_range_file(root() / "x.perc", std::nullopt);
  ASSERT_TRUE(source) << source.error().message;
  const auto delivered = drain(**source);
  ASSERT_EQ(delivered.frames.size(), 1u);
  const SensorConfig& sensor = *delivered.frames[0]->sensor;
  EXPECT_EQ(sensor.projection.kind, ProjectionKind::perceptron_usf);
  EXPECT_EQ(sensor.filter.phase, PhasePolicy::first_interval);
  EXPECT_LT((sensor.T_body_sensor * Eigen::Vector3d(1, 2, 3) - Eigen::Vector3d(3, 1, 2)).norm(), 1e-12);

  write("cmu", std::string(131072, '\1'));
  const auto cmu = open_range_file(root() / "cmu", std::nullopt);
  ASSERT_TRUE(cmu) << cmu.error().message;
  EXPECT_EQ(drain(**cmu).frames[0]->projection->config.kind, ProjectionKind::perceptron_cmu);
}

TEST_F(RecordingTest, SingleFileOfAnotherKindThanItsSensorIsABadConfiguration) {
  RangeFile file;
  file.raw.assign(3, 4, 100);
  const auto bytes = encode_range_file(file);
  ASSERT_TRUE(bytes);
  write("usf.perc", std::string(bytes->begin(), bytes->end()));
  write("cmu.perc", std::string(262144, '\1'));
  write("depth.pgm", "P5\n2 2\n65535\n12345678");
  const auto refusal = [&](const char* name, ProjectionKind kind) {
    SensorConfig sensor;
    sensor.projection.kind = kind;
    sensor.projection.fx_px = sensor.projection.fy_px = 2;
    const auto source = open_range_file(root() / name, sensor);
    if (source) return std::string("accepted");
    EXPECT_EQ(source.error().kind, ErrorKind::bad_config);
    return source.error().message;
  };
  EXPECT_THAT(refusal("usf.perc", ProjectionKind::perceptron_cmu),
              HasSubstr("expected a headerless CMU range file (projection perceptron_cmu), found a range file: USF"));
  EXPECT_THAT(refusal("usf.perc", ProjectionKind::pinhole),
              HasSubstr("expected a 16-bit .pgm image (projection pinhole), found a range file: USF"));
  EXPECT_THAT(refusal("usf.perc", ProjectionKind::cloud), HasSubstr("(projection cloud), found a range file: USF"));
  EXPECT_THAT(refusal("cmu.perc", ProjectionKind::perceptron_usf),
              HasSubstr("(projection perceptron_usf), found a range file: headerless CMU words"));
  EXPECT_THAT(refusal("depth.pgm", ProjectionKind::perceptron_usf),
              HasSubstr("(projection perceptron_usf), found a 16-bit .pgm image"));
  EXPECT_EQ(refusal("usf.perc", ProjectionKind::perceptron_usf), "accepted");
  EXPECT_EQ(refusal("cmu.perc", ProjectionKind::perceptron_cmu), "accepted");
  EXPECT_EQ(refusal("depth.pgm", ProjectionKind::pinhole), "accepted");
}

/// Reflectances 0 … 11 at bit 12, row after row.
std::string file_with_reflectances() {
  RangeFile file;
  file.raw.assign(3, 4, 100);
  file.reflectance.assign(3, 4, 0);
  for (std::size_t i = 0; i < 12; ++i) file.reflectance[i] = static_cast<std::uint16_t>(i);
  const auto bytes = encode_range_file(file, 12);
  return bytes ? std::string(bytes->begin(), bytes->end()) : std::string();
}

TEST_F(RecordingTest, ReturnsBelowTheLeastReflectanceAreNoReturns) {
  write("x.perc", file_with_reflectances());
  SensorConfig sensor;
  sensor.projection.reflectance_shift = 12;
  for (const int least : {0, 1, 5, 12}) {
    sensor.filter.min_reflectance = least;
    const auto source = open_range_file(root() / "x.perc", sensor);
    ASSERT_TRUE(source) << source.error().message;
    const auto frames = drain(**source).frames;
    ASSERT_EQ(frames.size(), 1u);
    for (int i = 0; i < 12; ++i)
      EXPECT_EQ(std::isnan(frames[0]->range_m[static_cast<std::size_t>(i)]), i < least) << i << " of " << least;
  }
}

TEST_F(RecordingTest, FileWithoutReflectancesCannotBeFilteredByThem) {
  write("x.perc", std::string(131072, '\1'));
  SensorConfig sensor;
  sensor.projection.kind = ProjectionKind::perceptron_cmu;
  sensor.projection.reflectance_shift = 12;
  sensor.filter.min_reflectance = 5;
  const auto source = open_range_file(root() / "x.perc", sensor);
  ASSERT_TRUE(source);
  const auto event = (*source)->next(std::chrono::milliseconds(0));
  ASSERT_TRUE(event);
  EXPECT_EQ(event->kind, SourceEvent::Kind::skipped);
  EXPECT_THAT(event->message, HasSubstr("expected words with a reflectance (min_reflectance 5)"));
}

/// Distances along the rays, cm, 0 = sky; empty where the file does not hold them all.
std::vector<float> truth_of(const std::filesystem::path& file, std::size_t pixels) {
  std::vector<float> truth_cm(pixels);
  std::ifstream stream(file.parent_path() / "synthetic_msh.truth_t_cm.f32", std::ios::binary);
  if (!stream.read(reinterpret_cast<char*>(truth_cm.data()), static_cast<std::streamsize>(4 * pixels))) return {};
  return truth_cm;
}

// Its sky has reflectances of at most 38; of the surface 0.2 % are as dark, where it is seen nearly edge-on.
TEST(RecordedData, LeastReflectanceTakesTheSkyOfTheSyntheticFileAndNextToNothingElse) {
  const auto path = test::shared_data("perceptron_SYNTHETIC/synthetic_msh.perc");
  SCREE_SKIP_WITHOUT(path, "perceptron_SYNTHETIC");
  SensorConfig sensor;
  sensor.projection.reflectance_shift = 12;
  sensor.filter.min_reflectance = 40;
  const auto source = open_range_file(*path, sensor);
  ASSERT_TRUE(source) << source.error().message;
  const auto delivered = drain(**source);
  ASSERT_EQ(delivered.frames.size(), 1u);
  const RangeFrame& frame = *delivered.frames[0];
  const auto truth_cm = truth_of(*path, frame.range_m.size());
  ASSERT_EQ(truth_cm.size(), frame.range_m.size());
  int sky_left = 0, surface = 0, surface_lost = 0;
  for (std::size_t i = 0; i < truth_cm.size(); ++i) {
    const bool dropped = std::isnan(frame.range_m[i]);
    if (truth_cm[i] > 0.0f) {
      ++surface;
      surface_lost += dropped ? 1 : 0;
    } else {
      sky_left += dropped ? 0 : 1;
    }
  }
  EXPECT_EQ(sky_left, 0);
  EXPECT_LT(surface_lost, surface / 200);
}

TEST_F(RecordingTest, SingleFileThatIsBadOrMissingIsRefusedAtOnce) {
  write("x.perc", "rows: 0\ncolumns: 3\n");
  EXPECT_EQ(open_range_file(root() / "x.perc", std::nullopt).error().kind, ErrorKind::bad_data);
  EXPECT_EQ(open_range_file(root() / "y.perc", std::nullopt).error().kind, ErrorKind::no_input);
  EXPECT_EQ(open_range_file(root() / "y.perc", SensorConfig{}).error().kind, ErrorKind::no_input);
}

// The file's own description: sky pixels 10.5 %; distance along the exit ray has an error sd of 0.21 … 0.89 cm. Three
// standard deviations of the worst class bound the rms of all.
TEST(RecordedData, SyntheticPerceptronFileAgreesWithItsTruth) {
  const auto path = test::shared_data("perceptron_SYNTHETIC/synthetic_msh.perc");
  SCREE_SKIP_WITHOUT(path, "perceptron_SYNTHETIC");
  const auto source = open_range_file(*path, std::nullopt);
  ASSERT_TRUE(source) << source.error().message;
  const auto delivered = drain(**source);
  ASSERT_EQ(delivered.frames.size(), 1u);
  const RangeFrame& frame = *delivered.frames[0];
  const auto truth_cm = truth_of(*path, frame.range_m.size());
  ASSERT_EQ(truth_cm.size(), frame.range_m.size());
  std::array<double, 3> sum{}, squares{};
  std::array<int, 3> count{};
  for (std::size_t i = 0; i < truth_cm.size(); ++i) {
    if (truth_cm[i] <= 0.0f) continue;
    const double error_cm = 100.0 * static_cast<double>(frame.range_m[i]) - static_cast<double>(truth_cm[i]);
    if (std::abs(error_cm) > 7.5) continue;  // mixed pixels: "tails to ±7 cm"
    const std::size_t band = truth_cm[i] < 300.0f ? 0 : truth_cm[i] < 600.0f ? 1 : 2;
    sum[band] += error_cm;
    squares[band] += error_cm * error_cm;
    ++count[band];
  }
  const std::array<double, 3> published_sd_cm{0.21, 0.39, 0.89};
  for (std::size_t band = 0; band < 3; ++band) {
    const double mean = sum[band] / count[band];
    const double sd = std::sqrt(squares[band] / count[band] - mean * mean);
    EXPECT_NEAR(sd, published_sd_cm[band], 0.02) << "band " << band;
    EXPECT_NEAR(mean, 0.0, 0.05) << "band " << band;
  }
}

}  // namespace
}  // namespace scree::drivers
