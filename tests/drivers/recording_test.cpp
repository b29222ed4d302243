#include "drivers/recording.hpp"

#include <array>
#include <cmath>
#include <fmt/format.h>
#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <numbers>
#include <utility>

#include "drivers/depth_image.hpp"
#include "drivers/perceptron_file.hpp"
#include "tests/support/shared_data.hpp"
#include "tests/support/temporary_folder.hpp"

namespace scree::drivers {
namespace {

using testing::HasSubstr;
using namespace std::chrono_literals;
using Kind = SourceEvent::Kind;

constexpr const char* kPoses = "t_s,x_m,y_m,z_m,qx,qy,qz,qw\n";

SensorConfig depth_camera() {
  SensorConfig sensor;
  auto& projection = sensor.projection;
  projection.kind = ProjectionKind::pinhole;
  projection.fx_px = projection.fy_px = 2.0;
  projection.cx_px = 1.0;
  projection.cy_px = 0.5;
  return sensor;
}

SensorConfig of_kind(ProjectionKind kind) {
  SensorConfig sensor;
  sensor.projection.kind = kind;
  return sensor;
}

SensorConfig cmu_scanner(Duration row_period) {
  SensorConfig sensor;
  sensor.projection.kind = ProjectionKind::perceptron_cmu;
  sensor.row_period = row_period;
  return sensor;
}

Time at(double t_s) {
  return Time(from_seconds(t_s));
}

/// What a source delivered until its end.
struct Delivered {
  std::vector<std::shared_ptr<const RangeFrame>> frames;
  std::vector<std::string> skipped;
  std::optional<Error> error;
};

Delivered drain(Source& source) {
  Delivered delivered;
  for (;;) {
    const auto event = source.next(0ms);
    if (!event) {
      delivered.error = event.error();
      return delivered;
    }
    if (event->kind == Kind::end_of_stream) return delivered;
    if (event->kind == Kind::frame) delivered.frames.push_back(event->frame);
    if (event->kind == Kind::skipped) delivered.skipped.push_back(event->message);
  }
}

class RecordingTest : public testing::Test {
 protected:
  std::filesystem::path root() const { return directory_.path() / "recording"; }

  void write(const std::string& name, const std::string& text) const {
    std::filesystem::create_directories((root() / name).parent_path());
    std::ofstream(root() / name, std::ios::binary) << text;
  }

  /// A recording of 2 × 3 depth images at 0, 1, 2 s, driven along x at 1 m/s; poses at 0, 1, … 10 s.
  void write_depth_recording(int frames) const {
    auto writer = RecordingWriter::create(root(), "scree_recording: 1\n");
    ASSERT_TRUE(writer) << writer.error().message;
    Grid<std::uint16_t> raw(2, 3, 1000);
    raw(0, 0) = 0;
    for (int i = 0; i < frames; ++i)
      ASSERT_TRUE(writer->add_raw_frame(ProjectionKind::pinhole, raw, at(i), static_cast<std::uint64_t>(i)));
    for (int i = 0; i <= 10; ++i)
      ASSERT_TRUE(writer->add_pose({at(i), {{1.0 * i, 0.0, 0.0}, Eigen::Quaterniond::Identity()}}));
    ASSERT_TRUE(writer->finish());
  }

  Result<std::unique_ptr<Source>> open(SensorConfig sensor = depth_camera(), ReplayWindow window = {}) const {
    return open_recording(root(), {Origin::sim, std::move(sensor)}, window);
  }

  Error open_error(SensorConfig sensor = depth_camera()) const {
    const auto source = open(std::move(sensor));
    return source ? Error{ErrorKind::internal, "accepted"} : source.error();
  }

  test::TemporaryFolder directory_;
};

TEST_F(RecordingTest, DepthFramesReadBackAsRanges) {
  write_depth_recording(2);
  const auto source = open();
  ASSERT_TRUE(source) << source.error().message;
  EXPECT_EQ((*source)->origin(), Origin::replay);
  EXPECT_EQ((*source)->frame_count(), 2u);
  const auto delivered = drain(**source);
  ASSERT_EQ(delivered.frames.size(), 2u);
  EXPECT_TRUE(delivered.skipped.empty());
  const RangeFrame& frame = *delivered.frames[1];
  EXPECT_EQ(frame.time, at(1.0));
  EXPECT_EQ(frame.sequence, 1u);
  EXPECT_TRUE(std::isnan(frame.range_m(0, 0))) << "0 is no return for depth images";
  EXPECT_NEAR(frame.range_m(0, 1), std::sqrt(1.0 + 0.25 * 0.25), 1e-6) << "range along the ray, not depth";
  ASSERT_EQ(frame.T_map_body.size(), 2u);
  EXPECT_NEAR(frame.T_map_body[1].translation_m.x(), 1.0, 1e-12);
}

TEST_F(RecordingTest, EveryPerceptronFrameReadsBackToItsCounts) {
  for (const auto kind : {ProjectionKind::perceptron_usf, ProjectionKind::perceptron_cmu}) {
    std::filesystem::remove_all(root());
    Grid<std::uint16_t> raw(256, 256);
    for (std::size_t i = 0; i < raw.size(); ++i) raw[i] = static_cast<std::uint16_t>((i * 2654435761u) >> 20 & 0xFFF);
    auto writer = RecordingWriter::create(root(), "");
    ASSERT_TRUE(writer);
    ASSERT_TRUE(writer->add_raw_frame(kind, raw, at(1.5), 3));
    ASSERT_TRUE(writer->add_pose({at(1.5), {}}));
    ASSERT_TRUE(writer->finish());
    const auto source = open(of_kind(kind));
    ASSERT_TRUE(source) << source.error().message;
    const auto delivered = drain(**source);
    ASSERT_EQ(delivered.frames.size(), 1u);
    const RangeFrame& frame = *delivered.frames[0];
    for (std::size_t i = 0; i < raw.size(); ++i) {
      const auto& p = *frame.projection;
      ASSERT_EQ(std::lround((frame.range_m[i] - p.range_offset_m[i]) / p.range_per_count_m[i]), raw[i]);
    }
  }
}

TEST_F(RecordingTest, DeclaredInvalidCodeHasNoRange) {
  Grid<std::uint16_t> raw(256, 256, 7);
  raw(3, 4) = 0;
  auto writer = RecordingWriter::create(root(), "");
  ASSERT_TRUE(writer);
  ASSERT_TRUE(writer->add_raw_frame(ProjectionKind::perceptron_cmu, raw, at(0), 0));
  ASSERT_TRUE(writer->add_pose({at(0.0), {}}));
  ASSERT_TRUE(writer->finish());
  for (const std::int64_t invalid : {-1, 0}) {
    SensorConfig sensor = cmu_scanner({});
    sensor.projection.invalid_raw = invalid;
    const auto source = open(std::move(sensor));
    ASSERT_TRUE(source);
    const auto delivered = drain(**source);
    ASSERT_EQ(delivered.frames.size(), 1u);
    EXPECT_EQ(std::isnan(delivered.frames[0]->range_m(3, 4)), invalid == 0)
        << "0 is legal data unless declared invalid";
    EXPECT_FALSE(std::isnan(delivered.frames[0]->range_m(3, 5)));
  }
}

TEST_F(RecordingTest, CloudFramesReadBackAsPoints) {
  const std::vector<Eigen::Vector4f> points{{1, 2, 3, 9}, {std::nanf(""), 0, 0, 0}, {0, 0, 0, 0}, {-4, 0.5f, 0.25f, 1}};
  auto writer = RecordingWriter::create(root(), "");
  ASSERT_TRUE(writer);
  ASSERT_TRUE(writer->add_cloud_frame(points, at(0), 0));
  ASSERT_TRUE(writer->add_pose({at(0.0), {}}));
  ASSERT_TRUE(writer->finish());
  const auto source = open(of_kind(ProjectionKind::cloud));
  ASSERT_TRUE(source) << source.error().message;
  const auto delivered = drain(**source);
  ASSERT_EQ(delivered.frames.size(), 1u);
  const RangeFrame& frame = *delivered.frames[0];
  ASSERT_EQ(frame.range_m.columns(), 4) << "points without a range keep their pixel, to be counted";
  EXPECT_TRUE(std::isnan(frame.range_m(0, 1)));
  EXPECT_TRUE(std::isnan(frame.range_m(0, 2)));
  for (const int i : {0, 3}) {
    const auto& p = *frame.projection;
    const Eigen::Vector3f direction(p.direction_x(0, i), p.direction_y(0, i), p.direction_z(0, i));
    EXPECT_LT((direction * frame.range_m(0, i) - points[static_cast<std::size_t>(i)].head<3>()).norm(), 1e-5f);
  }
}

TEST_F(RecordingTest, EveryRowHasThePoseOfItsOwnTime) {
  auto writer = RecordingWriter::create(root(), "");
  ASSERT_TRUE(writer);
  ASSERT_TRUE(writer->add_raw_frame(ProjectionKind::perceptron_cmu, Grid<std::uint16_t>(256, 256, 5), at(1.0), 0));
  const Eigen::Quaterniond eighth(Eigen::AngleAxisd(std::numbers::pi / 4, Eigen::Vector3d::UnitZ()));
  const Eigen::Quaterniond quarter(Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitZ()));
  ASSERT_TRUE(writer->add_pose({at(1.0), {{2.0, 0.0, 0.0}, eighth}}));
  ASSERT_TRUE(writer->add_pose({at(2.0), {{4.0, 0.0, 0.0}, quarter}}));
  ASSERT_TRUE(writer->finish());
  const auto source = open(cmu_scanner(1953125ns));  // 256 rows in half a second
  ASSERT_TRUE(source);
  const auto delivered = drain(**source);
  ASSERT_EQ(delivered.frames.size(), 1u);
  const RangeFrame& frame = *delivered.frames[0];
  for (const int r : {0, 1, 128, 255}) {
    const auto row = static_cast<std::size_t>(r);
    const double t_s = 1.0 + r * 1953125e-9;
    EXPECT_EQ(frame.row_time[row].time_since_epoch(), 1s + r * 1953125ns);
    EXPECT_NEAR(frame.T_map_body[row].translation_m.x(), 2.0 * t_s, 1e-9);
    EXPECT_NEAR(frame.T_map_body[row].rotation.angularDistance(Eigen::Quaterniond::Identity()),
                std::numbers::pi / 4 * t_s, 1e-9);
  }
}

TEST_F(RecordingTest, FrameWhoseLastRowHasNoPoseIsSkipped) {
  auto writer = RecordingWriter::create(root(), "");
  ASSERT_TRUE(writer);
  for (const int i : {0, 1})
    ASSERT_TRUE(writer->add_raw_frame(ProjectionKind::perceptron_cmu, Grid<std::uint16_t>(256, 256, 5), at(i), 0));
  ASSERT_TRUE(writer->add_pose({at(0.0), {}}));
  ASSERT_TRUE(writer->add_pose({at(1.2), {}}));
  ASSERT_TRUE(writer->finish());
  const auto source = open(cmu_scanner(1953125ns));
  ASSERT_TRUE(source);
  const auto delivered = drain(**source);
  EXPECT_EQ(delivered.frames.size(), 1u);
  ASSERT_EQ(delivered.skipped.size(), 1u);
  EXPECT_THAT(delivered.skipped[0],
              HasSubstr("000001.perc: expected a pose at 1.201171875 s (row 103), the poses cover 0 to 1.2 s"));
}

TEST_F(RecordingTest, OneBadFrameIsSkippedWithItsReason) {
  write_depth_recording(4);
  write("frames/000001.pgm", "P5\n3 2\n65535\n123");
  std::filesystem::remove(root() / "frames/000002.pgm");
  write("frames/000003.pgm", "P5\n1 1\n65535\n12");
  const auto source = open();
  ASSERT_TRUE(source);
  const auto delivered = drain(**source);
  EXPECT_EQ(delivered.frames.size(), 1u);
  EXPECT_FALSE(delivered.error);
  ASSERT_EQ(delivered.skipped.size(), 3u);
  EXPECT_THAT(delivered.skipped[0], HasSubstr("found 3: the file is truncated"));
  EXPECT_THAT(delivered.skipped[1], HasSubstr("000002.pgm: expected a file, found none"));
  EXPECT_THAT(delivered.skipped[2],
              HasSubstr("expected an image of 2 rows and 3 columns, like the first, found 1 x 1"));
}

TEST_F(RecordingTest, NoGoodFrameAtAllIsBadDataAtTheEnd) {
  write_depth_recording(2);
  write("frames/000000.pgm", "");
  write("frames/000001.pgm", "garbage");
  const auto source = open();
  ASSERT_TRUE(source);
  const auto delivered = drain(**source);
  EXPECT_EQ(delivered.skipped.size(), 2u);
  ASSERT_TRUE(delivered.error);
  EXPECT_EQ(delivered.error->kind, ErrorKind::bad_data);
  EXPECT_THAT(delivered.error->message, HasSubstr("expected at least one good frame, found none among 2"));
}

TEST_F(RecordingTest, MissingPartsAreNoInput) {
  EXPECT_EQ(open_error().kind, ErrorKind::no_input);
  for (const char* part : {"frames.csv", "poses.csv", "frames"}) {
    std::filesystem::remove_all(root());
    write_depth_recording(1);
    std::filesystem::remove_all(root() / part);
    const Error error = open_error();
    EXPECT_EQ(error.kind, ErrorKind::no_input) << part;
    EXPECT_THAT(error.message, HasSubstr((root() / part).string() + ": expected a ")) << part;
  }
}

TEST_F(RecordingTest, BadTablesAreBadDataWithFileAndLine) {
  write_depth_recording(1);
  write("poses.csv", std::string(kPoses) + "0,nan,0,0,0,0,0,1\n");
  EXPECT_EQ(open_error().kind, ErrorKind::bad_data);
  EXPECT_THAT(open_error().message, HasSubstr("poses.csv:2: x_m: expected a finite number, found 'nan'"));
  write("poses.csv", kPoses);
  EXPECT_THAT(open_error().message, HasSubstr("expected at least one pose, found none"));
  write("frames.csv", "file,t_s,sequence\n../secret,0,0\n");
  EXPECT_THAT(open_error().message, HasSubstr("frames.csv:2: expected a path inside frames/"));
}

TEST_F(RecordingTest, PosesThatCoverNoFrameAreBadData) {
  write_depth_recording(3);
  write("poses.csv", std::string(kPoses) + "100,0,0,0,0,0,0,1\n101,0,0,0,0,0,0,1\n");
  EXPECT_EQ(open_error().kind, ErrorKind::bad_data);
  EXPECT_THAT(open_error().message,
              HasSubstr("expected poses at the times of the frames, 0 to 2 s; the poses cover 100 to 101 s"));
}

TEST_F(RecordingTest, OnePoseCoversItsOwnTimeOnly) {
  write_depth_recording(3);
  write("poses.csv", std::string(kPoses) + "100,7,0,0,0,0,0,1\n");
  EXPECT_EQ(open_error().kind, ErrorKind::bad_data);
  EXPECT_THAT(open_error().message, HasSubstr("times of the frames, 0 to 2 s; the poses cover 100 s only, no frame"));
  write("poses.csv", std::string(kPoses) + "1,7,0,0,0,0,0,1\n");
  const auto source = open();
  ASSERT_TRUE(source) << source.error().message;
  const auto delivered = drain(**source);
  ASSERT_EQ(delivered.frames.size(), 1u);
  EXPECT_EQ(delivered.frames[0]->T_map_body[1].translation_m.x(), 7.0)
      << "rows without a period share the frame's time";
  ASSERT_EQ(delivered.skipped.size(), 2u);
  EXPECT_THAT(delivered.skipped[1], HasSubstr("expected a pose at 2 s (row 0), the poses cover 1 s only"));
}

TEST_F(RecordingTest, OnePoseDoesNotCoverTheLaterRowsOfAFrame) {
  auto writer = RecordingWriter::create(root(), "");
  ASSERT_TRUE(writer);
  ASSERT_TRUE(writer->add_raw_frame(ProjectionKind::perceptron_cmu, Grid<std::uint16_t>(256, 256, 5), at(1), 0));
  ASSERT_TRUE(writer->add_pose({at(1), {}}));
  ASSERT_TRUE(writer->finish());
  const auto source = open(cmu_scanner(1ms));
  ASSERT_TRUE(source);
  const auto delivered = drain(**source);
  ASSERT_TRUE(delivered.error);
  EXPECT_EQ(delivered.error->kind, ErrorKind::bad_data);
  EXPECT_THAT(delivered.error->message, HasSubstr("expected a pose at 1.001 s (row 1), the poses cover 1 s only"));
}

TEST_F(RecordingTest, FramesInsideAGapOfThePosesAreSkipped) {
  write_depth_recording(3);
  write("poses.csv", std::string(kPoses) + "0,0,0,0,0,0,0,1\n0.5,0,0,0,0,0,0,1\n1.75,1,0,0,0,0,0,1\n2,1,0,0,0,0,0,1\n");
  const auto source = open();
  ASSERT_TRUE(source) << source.error().message;
  const auto delivered = drain(**source);
  EXPECT_EQ(delivered.frames.size(), 2u);
  ASSERT_EQ(delivered.skipped.size(), 1u);
  EXPECT_THAT(delivered.skipped[0],
              HasSubstr("000001.pgm: expected a pose at 1 s (row 0), the poses around it, at 0.5 and 1.75 s, are more "
                        "than 1 s apart and differ"));
  write("poses.csv", std::string(kPoses) + "-1000,0,0,0,0,0,0,1\n1000,9,0,0,0,0,0,1\n");
  EXPECT_EQ(open_error().kind, ErrorKind::bad_data);
  EXPECT_THAT(open_error().message, HasSubstr("at -1000 and 1000 s, are more than 1 s apart and differ, no frame"));
}

TEST_F(RecordingTest, TwoEqualPosesFarApartAreAStaticSensor) {
  write_depth_recording(3);
  write("poses.csv", std::string(kPoses) + "-1000,7,0,0,0,0,0,1\n1000,7,0,0,0,0,0,1\n");
  const auto source = open();
  ASSERT_TRUE(source) << source.error().message;
  const auto delivered = drain(**source);
  ASSERT_EQ(delivered.frames.size(), 3u);
  EXPECT_EQ(delivered.frames[2]->T_map_body[0].translation_m.x(), 7.0);
}

TEST_F(RecordingTest, WindowCutsByTime) {
  write_depth_recording(6);
  ReplayWindow window{1500ms, Duration(2s)};
  const auto source = open(depth_camera(), window);
  ASSERT_TRUE(source);
  const auto delivered = drain(**source);
  ASSERT_EQ(delivered.frames.size(), 2u);
  EXPECT_EQ(delivered.frames[0]->sequence, 2u);
  const auto behind = open(depth_camera(), {100s, std::nullopt});
  ASSERT_FALSE(behind);
  EXPECT_EQ(behind.error().kind, ErrorKind::usage);
}

TEST_F(RecordingTest, UsfProjectionWantsAHeader) {
  auto writer = RecordingWriter::create(root(), "");
  ASSERT_TRUE(writer);
  ASSERT_TRUE(writer->add_raw_frame(ProjectionKind::perceptron_cmu, Grid<std::uint16_t>(256, 256, 5), at(0), 0));
  ASSERT_TRUE(writer->add_pose({at(0.0), {}}));
  ASSERT_TRUE(writer->finish());
  const auto source = open(SensorConfig{});
  ASSERT_TRUE(source);
  const auto delivered = drain(**source);
  ASSERT_TRUE(delivered.error);
  EXPECT_THAT(delivered.error->message, HasSubstr("expected a range file with a USF header (projection "
                                                  "perceptron_usf), found a range file: headerless CMU words"));
}

TEST_F(RecordingTest, FramesOutliveTheirSourceAndAreNotOverwritten) {
  write_depth_recording(3);
  std::vector<std::shared_ptr<const RangeFrame>> kept;
  {
    const auto source = open();
    ASSERT_TRUE(source);
    kept = drain(**source).frames;
  }
  ASSERT_EQ(kept.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(kept[i]->sequence, i);
}

TEST_F(RecordingTest, WriterRefusesADirectoryThatHoldsFiles) {
  write_depth_recording(1);
  const auto again = RecordingWriter::create(root(), "");
  ASSERT_FALSE(again);
  EXPECT_EQ(again.error().kind, ErrorKind::cannot_create);
  EXPECT_THAT(again.error().message, HasSubstr("expected a new or empty directory"));
  const auto on_file = RecordingWriter::create(root() / "poses.csv", "");
  ASSERT_FALSE(on_file);
  EXPECT_EQ(on_file.error().kind, ErrorKind::cannot_create);
  const auto in_proc = RecordingWriter::create("/proc/recording", "");
  ASSERT_FALSE(in_proc);
  EXPECT_EQ(in_proc.error().kind, ErrorKind::cannot_create);
}

TEST_F(RecordingTest, WriterRefusesWhatTheReaderWould) {
  auto writer = RecordingWriter::create(root(), "");
  ASSERT_TRUE(writer);
  const Grid<std::uint16_t> raw(2, 3, 1);
  ASSERT_TRUE(writer->add_raw_frame(ProjectionKind::pinhole, raw, at(1), 0));
  EXPECT_FALSE(writer->add_raw_frame(ProjectionKind::pinhole, raw, at(1), 1)) << "time stands still";
  EXPECT_FALSE(writer->add_raw_frame(ProjectionKind::cloud, raw, at(2), 1));
  EXPECT_FALSE(writer->add_raw_frame(ProjectionKind::perceptron_usf, Grid<std::uint16_t>(2, 2, 5000), at(2), 1));
  ASSERT_TRUE(writer->add_pose({at(1), {}}));
  EXPECT_FALSE(writer->add_pose({at(0), {}}));
  EXPECT_FALSE(writer->add_pose({at(2), {{std::nan(""), 0, 0}, Eigen::Quaterniond::Identity()}}));
  EXPECT_FALSE(writer->add_pose({at(2), {{0, 0, 0}, Eigen::Quaterniond(2, 0, 0, 0)}}));
  ASSERT_TRUE(writer->finish());
  EXPECT_TRUE(open()) << "the refused rows are not in the tables";
}

TEST_F(RecordingTest, VanishedDirectoryIsAnErrorOfTheFrame) {
  auto writer = RecordingWriter::create(root(), "");
  ASSERT_TRUE(writer);
  std::filesystem::remove_all(root() / "frames");
  const auto added = writer->add_raw_frame(ProjectionKind::pinhole, Grid<std::uint16_t>(2, 3, 1), at(0), 0);
  ASSERT_FALSE(added);
  EXPECT_EQ(added.error().kind, ErrorKind::cannot_create);
}

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
  std::vector<float> truth_cm(frame.range_m.size());
  std::ifstream stream(path->parent_path() / "synthetic_msh.truth_t_cm.f32", std::ios::binary);
  ASSERT_TRUE(stream.read(reinterpret_cast<char*>(truth_cm.data()), static_cast<std::streamsize>(4 * truth_cm.size())));
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
  std::vector<float> truth_cm(frame.range_m.size());
  std::ifstream stream(path->parent_path() / "synthetic_msh.truth_t_cm.f32", std::ios::binary);
  ASSERT_TRUE(stream.read(reinterpret_cast<char*>(truth_cm.data()), static_cast<std::streamsize>(4 * truth_cm.size())));
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

TEST_F(RecordingTest, KinectFramesWithTheirPosesMakeARecording) {
  const auto data = test::shared_data("rgbd_kinect_slambook2");
  SCREE_SKIP_WITHOUT(data, "rgbd_kinect_slambook2");
  auto writer = RecordingWriter::create(root(), "");
  ASSERT_TRUE(writer);
  std::ifstream poses(*data / "pose.txt");
  for (int i = 1; i <= 5; ++i) {
    StampedPose pose;
    auto& t = pose.T_map_body.translation_m;
    auto& q = pose.T_map_body.rotation;
    ASSERT_TRUE(poses >> t.x() >> t.y() >> t.z() >> q.x() >> q.y() >> q.z() >> q.w());
    pose.time = at(i);
    const auto raw = read_depth_image(*data / fmt::format("depth_{}.pgm", i));
    ASSERT_TRUE(raw) << raw.error().message;
    ASSERT_TRUE(writer->add_raw_frame(ProjectionKind::pinhole, *raw, at(i), static_cast<std::uint64_t>(i)));
    ASSERT_TRUE(writer->add_pose(pose));
  }
  ASSERT_TRUE(writer->finish());
  SensorConfig sensor = depth_camera();
  sensor.projection.fx_px = 518.0;
  sensor.projection.fy_px = 519.0;
  sensor.projection.cx_px = 325.5;
  sensor.projection.cy_px = 253.5;
  const auto source = open(sensor);
  ASSERT_TRUE(source) << source.error().message;
  const auto delivered = drain(**source);
  ASSERT_EQ(delivered.frames.size(), 5u);
  EXPECT_EQ(delivered.frames[4]->T_map_body[479].translation_m.x(), -1.55819);
}

}  // namespace
}  // namespace scree::drivers
