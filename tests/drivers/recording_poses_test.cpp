#include <numbers>

#include "drivers/depth_image.hpp"
#include "tests/drivers/recording_fixture.hpp"

namespace scree::drivers {
namespace {

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

}  // namespace
}  // namespace scree::drivers
