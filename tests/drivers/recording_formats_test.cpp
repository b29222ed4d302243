// KITTI odometry and PCD directories.

#include <array>
#include <fmt/format.h>
#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "drivers/recording.hpp"
#include "tests/support/temporary_folder.hpp"

namespace scree::drivers {
namespace {

using testing::HasSubstr;
using namespace std::chrono_literals;

class Directory : public testing::Test {
 protected:
  std::filesystem::path root() const { return directory_.path(); }
  void write(const std::string& name, const std::string& content) const {
    std::filesystem::create_directories((root() / name).parent_path());
    std::ofstream(root() / name, std::ios::binary) << content;
  }
  static std::string point(float x, float y, float z) {
    const std::array<float, 4> values{x, y, z, 0.5f};
    return {reinterpret_cast<const char*>(values.data()), 16};
  }
  static Error error_of(const Result<std::unique_ptr<Source>>& source) {
    return source ? Error{ErrorKind::internal, "accepted"} : source.error();
  }
  test::TemporaryFolder directory_;
};

/// The one point of a cloud frame in the map.
Eigen::Vector3d point_in_map(const RangeFrame& frame) {
  const auto& p = *frame.projection;
  const Eigen::Vector3d direction(p.direction_x[0], p.direction_y[0], p.direction_z[0]);
  return frame.T_map_body[0] * (frame.sensor->T_body_sensor * Eigen::Vector3d(direction * frame.range_m[0]));
}

class Kitti : public Directory {
 protected:
  /// Two scans. The camera sits 0.27 m ahead of the Velodyne and 0.08 m below it, looking forward; between the scans it
  /// drives 2 m forward (camera z) and turns 90° to the left (about camera −y).
  void SetUp() override {
    write("velodyne/000000.bin", point(10, 1, -1));
    write("velodyne/000001.bin", point(10, 1, -1));
    write("times.txt", "0.000000e+00\n1.036000e-01\n");
    write("poses.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n0 0 -1 0 0 1 0 0 1 0 0 2\n");
    write("calib.txt", "P0: 7 0 6 0 0 7 1 0 0 0 1 0\nTr: 0 -1 0 0 0 0 -1 -0.08 1 0 0 -0.27\n");
  }
  Result<std::unique_ptr<Source>> open() const { return open_kitti(root(), SensorConfig{}, {}); }
};

TEST_F(Kitti, CameraPosesBecomeVelodynePosesInAMapWithZUp) {
  const auto source = open();
  ASSERT_TRUE(source) << source.error().message;
  const auto first = (*source)->next(0ms), second = (*source)->next(0ms), end = (*source)->next(0ms);
  ASSERT_TRUE(first && second && end);
  ASSERT_TRUE(first->frame && second->frame);
  EXPECT_EQ(end->kind, SourceEvent::Kind::end_of_stream);
  EXPECT_EQ(second->frame->time.time_since_epoch(), 103600us);
  EXPECT_EQ(second->frame->sequence, 1u);
  // The map's origin is the first camera: x forward, y left, z up.
  EXPECT_LT((point_in_map(*first->frame) - Eigen::Vector3d(9.73, 1.0, -0.92)).norm(), 1e-5);
  // After the turn the Velodyne's x is the map's y: (9.73, 1) from the camera → (−1, 9.73), plus 2 m forward.
  EXPECT_LT((point_in_map(*second->frame) - Eigen::Vector3d(1.0, 9.73, -0.92)).norm(), 1e-5);
}

TEST_F(Kitti, MissingScansAreToldByTheirNumbers) {
  std::filesystem::remove(root() / "velodyne/000000.bin");
  const auto source = open();
  ASSERT_TRUE(source) << source.error().message;
  const auto only = (*source)->next(0ms);
  ASSERT_TRUE(only && only->frame);
  EXPECT_EQ(only->frame->sequence, 1u);
  EXPECT_EQ(only->frame->time.time_since_epoch(), 103600us);
}

TEST_F(Kitti, EachMissingPartIsNoInput) {
  for (const char* part : {"velodyne", "times.txt", "poses.txt", "calib.txt"}) {
    SetUp();
    std::filesystem::remove_all(root() / part);
    EXPECT_EQ(error_of(open()).kind, ErrorKind::no_input) << part;
    EXPECT_THAT(error_of(open()).message, HasSubstr((root() / part).string())) << part;
  }
}

TEST_F(Kitti, EachMisformattedPartIsOneMessage) {
  const auto refuses = [&](const char* file, const char* content, const char* expected) {
    SetUp();
    write(file, content);
    EXPECT_EQ(error_of(open()).kind, ErrorKind::bad_data) << file;
    EXPECT_THAT(error_of(open()).message, HasSubstr(expected));
  };
  refuses("times.txt", "0\nx\n", "times.txt:2: expected decimal seconds, found 'x'");
  refuses("times.txt", "1\n1\n", "times.txt:2: expected a time above 1 s");
  refuses("times.txt", "0\n1\n2\n", "poses.txt: expected one pose for each of the 3 lines of times.txt, found 2");
  refuses("poses.txt", "1 0 0 0 0 1 0 0 0 0 1\n",
          "poses.txt:1: expected the 12 numbers of a 3 x 4 transform, found 11");
  refuses("poses.txt", "1 0 0 0 0 1 0 0 0 0 1 nan\n", "expected a finite number, found 'nan'");
  refuses("poses.txt", "1 0 0 0 0 1 0 0 0 0 2 0\n", "expected a rigid transform");
  refuses("poses.txt", "1 0 0 0 0 1 0 0 0 0 -1 0\n", "expected a rigid transform");
  refuses("calib.txt", "P0: 1 2 3\n", "expected a line 'Tr: <12 numbers>'");
  refuses("calib.txt", "Tr: 1 2 3\n", "calib.txt:1: expected the 12 numbers");
}

class PcdDirectory : public Directory {
 protected:
  void SetUp() override {
    for (const char* name : {"a.pcd", "b.pcd"})
      write(name,
            "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 1\nHEIGHT 1\n"
            "VIEWPOINT 0 0 0 1 0 0 0\nPOINTS 1\nDATA ascii\n1 2 3\n");
    write("poses.csv", "t_s,x_m,y_m,z_m,qx,qy,qz,qw\n5,0,0,0,0,0,0,1\n6,10,0,0,0,0,0,1\n");
  }
  Result<std::unique_ptr<Source>> open() const { return open_pcd_directory(root(), SensorConfig{}, {}); }
};

TEST_F(PcdDirectory, FramesHaveTheTimesOfTheirPoses) {
  const auto source = open();
  ASSERT_TRUE(source) << source.error().message;
  const auto first = (*source)->next(0ms);
  if (!first && first.error().kind == ErrorKind::unavailable) GTEST_SKIP() << first.error().message;
  const auto second = (*source)->next(0ms);
  ASSERT_TRUE(first && second);
  ASSERT_TRUE(first->frame && second->frame) << first->message;
  EXPECT_EQ(second->frame->time.time_since_epoch(), 6s);
  EXPECT_LT((point_in_map(*second->frame) - Eigen::Vector3d(11, 2, 3)).norm(), 1e-5);
}

TEST_F(PcdDirectory, FramesTableGivesOtherTimes) {
  write("frames.csv", "file,t_s,sequence\nb.pcd,5.5,40\n");
  const auto source = open();
  ASSERT_TRUE(source) << source.error().message;
  EXPECT_EQ((*source)->frame_count(), 1u);
  const auto only = (*source)->next(0ms);
  if (!only && only.error().kind == ErrorKind::unavailable) GTEST_SKIP() << only.error().message;
  ASSERT_TRUE(only && only->frame);
  EXPECT_EQ(only->frame->sequence, 40u);
  EXPECT_LT((point_in_map(*only->frame) - Eigen::Vector3d(6, 2, 3)).norm(), 1e-5);
}

TEST_F(PcdDirectory, WithoutFramesTableEveryFileNeedsItsPose) {
  write("poses.csv", "t_s,x_m,y_m,z_m,qx,qy,qz,qw\n5,0,0,0,0,0,0,1\n");
  EXPECT_THAT(error_of(open()).message, HasSubstr("poses.csv: expected one pose for each of 2 *.pcd files"));
  std::filesystem::remove(root() / "poses.csv");
  EXPECT_EQ(error_of(open()).kind, ErrorKind::no_input);
}

}  // namespace
}  // namespace scree::drivers
