#include <cmath>
#include <fmt/format.h>

#include "drivers/depth_image.hpp"
#include "tests/drivers/recording_fixture.hpp"
#include "tests/support/shared_data.hpp"

namespace scree::drivers {
namespace {

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
