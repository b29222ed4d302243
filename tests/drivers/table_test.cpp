#include "drivers/table.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace scree::drivers {
namespace {

using testing::HasSubstr;
using testing::StartsWith;
using namespace std::chrono_literals;

std::string frames(const std::string& rows) {
  return "file,t_s,sequence\n" + rows;
}
std::string poses(const std::string& rows) {
  return "t_s,x_m,y_m,z_m,qx,qy,qz,qw\n" + rows;
}

template <class T>
std::string message(const Result<T>& result) {
  if (result) return "accepted";
  EXPECT_EQ(result.error().kind, ErrorKind::bad_data);
  return result.error().message;
}
std::string frames_message(const std::string& text) {
  return message(parse_frames_table(text, "frames.csv"));
}
std::string poses_message(const std::string& text) {
  return message(parse_poses_table(text, "poses.csv"));
}

TEST(FramesTable, TimesAreExactNanoseconds) {
  const auto rows = parse_frames_table(frames("frames/000000.perc,1699999999.123456789,7\n000001.perc, 1.7e9 ,8\r\n\n"),
                                       "frames.csv");
  ASSERT_TRUE(rows) << rows.error().message;
  ASSERT_EQ(rows->size(), 2u);
  EXPECT_EQ((*rows)[0].file, "frames/000000.perc");
  EXPECT_EQ((*rows)[0].time.time_since_epoch(), 1699999999123456789ns);
  EXPECT_EQ((*rows)[0].sequence, 7u);
  EXPECT_EQ((*rows)[1].file, "frames/000001.perc");
  EXPECT_EQ((*rows)[1].time.time_since_epoch(), 1700000000s);
}

TEST(FramesTable, PathsStayInsideTheRecording) {
  for (const char* path : {"../x.perc", "frames/../../x.perc", "/etc/passwd", "other/x.perc", "frames//x", "frames/",
                           "frames/./x", "", "..", "frames\\x", "truth/000000.range.npy"})
    EXPECT_THAT(frames_message(frames(std::string(path) + ",0,0\n")),
                StartsWith("frames.csv:2: expected a path inside frames/"))
        << path;
}

TEST(FramesTable, FaultsNameFileAndLine) {
  EXPECT_THAT(frames_message(""), StartsWith("frames.csv:1: expected the header 'file,t_s,sequence', found ''"));
  EXPECT_THAT(frames_message("000000.perc,0,0\n"), HasSubstr("frames.csv:1: expected the header"));
  EXPECT_THAT(frames_message(frames("")), HasSubstr("frames.csv:2: expected at least one frame"));
  EXPECT_THAT(frames_message(frames("a,0,0\nb,0,1\n")), HasSubstr("frames.csv:3: expected t_s above 0, found 0"));
  EXPECT_THAT(frames_message(frames("a,0\n")), HasSubstr("frames.csv:2: expected 3 columns"));
  EXPECT_THAT(frames_message(frames("a,0,1,2\n")), HasSubstr("found 4"));
  EXPECT_THAT(frames_message(frames("a,nan,1\n")), HasSubstr("expected t_s in decimal seconds"));
  EXPECT_THAT(frames_message(frames("a,9e9,1\n")), HasSubstr("within ±4e9"));
  EXPECT_THAT(frames_message(frames("a,0,-1\n")), HasSubstr("expected an unsigned sequence, found '-1'"));
  EXPECT_THAT(frames_message(frames("a,0,0\n\nb,1,1\n")), HasSubstr("frames.csv:3: expected a row"));
}

TEST(PosesTable, ReadsPoses) {
  const auto rows =
      parse_poses_table(poses("0,1,-2e-3,+3,0,0,0,1\n0.5,1e8,2,3,0,0,0.70710678,0.70710678"), "poses.csv");
  ASSERT_TRUE(rows) << rows.error().message;
  ASSERT_EQ(rows->size(), 2u);
  EXPECT_EQ((*rows)[0].T_map_body.translation_m, Eigen::Vector3d(1.0, -2e-3, 3.0));
  EXPECT_EQ((*rows)[1].T_map_body.rotation.z(), 0.70710678);
  EXPECT_EQ((*rows)[1].time.time_since_epoch(), 500ms);
}

TEST(PosesTable, FaultsNameFileAndLine) {
  EXPECT_THAT(poses_message("t_s,x_m\n"), HasSubstr("poses.csv:1: expected the header 't_s,x_m,y_m,z_m"));
  EXPECT_THAT(poses_message(poses("")), HasSubstr("expected at least one pose"));
  EXPECT_THAT(poses_message(poses("0,nan,0,0,0,0,0,1\n")),
              HasSubstr("poses.csv:2: x_m: expected a finite number, found 'nan'"));
  EXPECT_THAT(poses_message(poses("0,0,inf,0,0,0,0,1\n")), HasSubstr("y_m"));
  EXPECT_THAT(poses_message(poses("0,0,0,1e9,0,0,0,1\n")), HasSubstr("z_m: expected at most 1e+08 m"));
  EXPECT_THAT(poses_message(poses("0,0,0,0,0,0,0,0\n")), HasSubstr("quaternion of norm 1 ± 0.001, found 0"));
  EXPECT_THAT(poses_message(poses("0,0,0,0,0,0,0,1e300\n")), HasSubstr("quaternion of norm 1"));
  EXPECT_THAT(poses_message(poses("0,0,0,0,0,0,1\n")), HasSubstr("expected 8 columns"));
  EXPECT_THAT(poses_message(poses("1,0,0,0,0,0,0,1\n0.5,0,0,0,0,0,0,1\n")),
              HasSubstr("poses.csv:3: expected t_s above 1"));
  EXPECT_THAT(poses_message(poses("0,0x1,0,0,0,0,0,1\n")), HasSubstr("found '0x1'"));
}

TEST(PosesTable, RowsReadBackToTheSameBits) {
  const StampedPose pose{Time(1699999999123456789ns),
                         {{0.1 + 0.2, -1.0 / 3.0, 1e-17}, Eigen::Quaterniond(0.5, -0.5, 0.5, 0.5)}};
  const auto back = parse_poses_table(poses(format_pose_row(pose)), "poses.csv");
  ASSERT_TRUE(back) << back.error().message;
  EXPECT_EQ((*back)[0].time, pose.time);
  EXPECT_EQ((*back)[0].T_map_body.translation_m, pose.T_map_body.translation_m);
  EXPECT_EQ((*back)[0].T_map_body.rotation.coeffs(), pose.T_map_body.rotation.coeffs());
}

TEST(PosesTable, VariancesReadBackToTheSameBits) {
  const StampedPose pose{Time(1699999999123456789ns), {{1, 2, 3}, Eigen::Quaterniond(0.5, -0.5, 0.5, 0.5)}};
  const PoseVariance variance{{0.1 + 0.2, 1e-300, 0.0}, {1.0 / 3.0, 2.0, 5e-7}};
  const std::string text = std::string(kUncertainPosesHeader) + "\n" + format_uncertain_pose_row(pose, variance);
  const auto back = parse_uncertain_poses_table(text, "poses.csv");
  ASSERT_TRUE(back) << back.error().message;
  ASSERT_EQ(back->variances.size(), 1u);
  EXPECT_EQ(back->variances[0].position_m2, variance.position_m2);
  EXPECT_EQ(back->variances[0].attitude_rad2, variance.attitude_rad2);
  EXPECT_EQ(back->poses[0].T_map_body.translation_m, pose.T_map_body.translation_m);
  const auto plain = parse_uncertain_poses_table(poses("0,0,0,0,0,0,0,1\n"), "poses.csv");
  ASSERT_TRUE(plain);
  EXPECT_TRUE(plain->variances.empty()) << "the table tells none";
  EXPECT_THAT(poses_message(std::string(kUncertainPosesHeader) + "\n0,0,0,0,0,0,0,1,0,0,0,0,0,-1\n"),
              HasSubstr("poses.csv:2: expected a variance of at least 0, found '-1'"));
}

// What a writer that was killed in the middle of a row leaves behind, cut at every byte of it.
TEST(FramesTable, OfATornLastRowOnlyThatRowIsLost) {
  const std::string whole = frames("frames/000000.perc,1.5,7\nframes/000001.perc,2.5,8\n");
  const std::string first = frames("frames/000000.perc,1.5,7\n");
  for (std::size_t size = first.size(); size + 1 < whole.size(); ++size) {
    std::string torn;
    const auto rows = parse_frames_table(std::string_view(whole).substr(0, size), "frames.csv", "frames", &torn);
    ASSERT_TRUE(rows) << size << rows.error().message;
    EXPECT_GE(rows->size(), 1u) << size;
    EXPECT_EQ(rows->front().sequence, 7u);
    const bool lost = rows->size() == 1 && size > first.size();
    EXPECT_EQ(!torn.empty(), lost) << size;
    if (lost) {
      EXPECT_THAT(torn, HasSubstr("frames.csv:3: the last line has no end and is left out"));
    }
  }
  std::string torn;
  EXPECT_FALSE(parse_frames_table(first + "frames/000001.p\n", "frames.csv", "frames", &torn))
      << "a row with an end is not torn";
}

TEST(OrderTable, NamesFoldersAndPlaces) {
  const std::string header = std::string(kOrderHeader) + "\n";
  const auto rows = parse_order_table(header + "front,0\nlow,0\nfront,1\n", "order.csv");
  ASSERT_TRUE(rows) << rows.error().message;
  ASSERT_EQ(rows->size(), 3u);
  EXPECT_EQ((*rows)[2].recording, "front");
  EXPECT_EQ((*rows)[2].frame, 1u);
  for (const char* wrong : {"../x,0\n", "a/b,0\n", "..,0\n", "/,0\n", "a,-1\n", "a\n", ""})
    EXPECT_FALSE(parse_order_table(header + wrong, "order.csv")) << wrong;
}

// Half a number may be a number: what only this program writes has an end, or is left out.
TEST(OrderTable, ALastRowWithoutAnEndIsLeftOutEvenWhenItCanBeRead) {
  const std::string header = std::string(kOrderHeader) + "\n";
  std::string torn;
  const auto rows = parse_order_table(header + "cam,44\ncam,4", "order.csv", &torn);
  ASSERT_TRUE(rows);
  EXPECT_EQ(rows->size(), 1u);
  EXPECT_THAT(torn, HasSubstr("order.csv:3: the last line has no end and is left out"));
  const std::string row = "0,1,2,3,0,0,0,1,0,0,0,0,0,120";
  const auto poses = parse_uncertain_poses_table(
      std::string(kUncertainPosesHeader) + "\n" + row + "\n1" + row.substr(1, row.size() - 2), "poses.csv", &torn);
  ASSERT_TRUE(poses);
  EXPECT_EQ(poses->poses.size(), 1u);
  EXPECT_THAT(torn, HasSubstr("poses.csv:3"));
}

}  // namespace
}  // namespace scree::drivers
