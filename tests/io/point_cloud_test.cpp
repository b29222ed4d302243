#include "io/point_cloud.hpp"

#include <cstring>
#include <fmt/format.h>
#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <limits>

#include "tests/support/shared_data.hpp"
#include "tests/support/temporary_folder.hpp"

namespace scree::io {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

std::string text_message(const std::string& text) {
  const auto cloud = parse_point_text(text, "p.xyz");
  if (cloud) return "accepted";
  EXPECT_EQ(cloud.error().kind, ErrorKind::bad_data);
  return cloud.error().message;
}

class PointFile : public testing::Test {
 protected:
  std::filesystem::path write(const std::string& name, const std::string& content) const {
    const auto path = directory_.path() / name;
    std::ofstream(path, std::ios::binary) << content;
    return path;
  }
  std::string message(const std::string& name, const std::string& content) const {
    const auto cloud = read_point_cloud(write(name, content));
    if (cloud) return "accepted";
    EXPECT_EQ(cloud.error().kind, ErrorKind::bad_data) << cloud.error().message;
    EXPECT_THAT(cloud.error().message, StartsWith((directory_.path() / name).string()));
    return cloud.error().message;
  }
  test::TemporaryFolder directory_;
};

std::string floats(std::initializer_list<float> values) {
  std::string bytes(values.size() * 4, '\0');
  std::memcpy(bytes.data(), values.begin(), bytes.size());
  return bytes;
}

TEST(PointText, BlanksCommasAndSemicolonsSeparate) {
  for (const char* text : {"1 2.5 -3\n", "1,2.5,-3\n", "1 , 2.5 ,-3", "  1;2.5;\t-3\r\n", "\n+1\t2.5e0 -3.0\n\n"}) {
    const auto cloud = parse_point_text(text, "p.xyz");
    ASSERT_TRUE(cloud) << cloud.error().message;
    ASSERT_EQ(cloud->points.size(), 1u) << text;
    EXPECT_EQ(cloud->points[0], Eigen::Vector4f(1.0f, 2.5f, -3.0f, 0.0f));
    EXPECT_EQ(cloud->origin_m, Eigen::Vector3d::Zero());
  }
}

TEST(PointText, HeaderNamesTheColumns) {
  const auto cloud = parse_point_text("# made by hand\nIntensity,\"Z\",y_m,X\n9,3,2,1\n", "p.csv");
  ASSERT_TRUE(cloud) << cloud.error().message;
  EXPECT_EQ(cloud->points[0], Eigen::Vector4f(1.0f, 2.0f, 3.0f, 9.0f));
}

TEST(PointText, FourthOfFourColumnsIsTheIntensity) {
  EXPECT_EQ(parse_point_text("1 2 3 4\n", "p")->points[0][3], 4.0f);
  EXPECT_EQ(parse_point_text("1 2 3 4 5 6\n", "p")->points[0][3], 0.0f) << "colours or normals are no intensity";
}

TEST(PointText, SurveyCoordinatesKeepTheirMillimetres) {
  const auto cloud = parse_point_text("515368.123 4918340.456 2322.789\n515401.001 4918381.002 2330.003\n", "p.xyz");
  ASSERT_TRUE(cloud);
  EXPECT_EQ(cloud->origin_m, Eigen::Vector3d(515368.0, 4918340.0, 2322.0));
  const Eigen::Vector3d last = cloud->points[1].head<3>().cast<double>() + cloud->origin_m;
  EXPECT_NEAR((last - Eigen::Vector3d(515401.001, 4918381.002, 2330.003)).norm(), 0.0, 1e-5);
}

TEST(PointText, NonFinitePointsAreDroppedAndCounted) {
  const auto cloud = parse_point_text("1 2 3\nnan 2 3\n1 inf 3\n1 2 1e999\n4 5 6\n", "p.xyz");
  ASSERT_TRUE(cloud);
  EXPECT_EQ(cloud->points.size(), 2u);
  EXPECT_EQ(cloud->dropped_non_finite, 3u);
}

TEST(PointText, FaultsNameTheLine) {
  EXPECT_THAT(text_message(""), HasSubstr("p.xyz: expected at least one finite point"));
  EXPECT_THAT(text_message("nan nan nan\n"), HasSubstr("found 1 points, none finite"));
  EXPECT_THAT(text_message("1 2\n"), HasSubstr("p.xyz:1: expected at least 3 columns, found 2"));
  EXPECT_THAT(text_message("1 2 3\n\n1 2 3 4\n"),
              HasSubstr("p.xyz:3: expected 3 columns like the first line, found 4"));
  EXPECT_THAT(text_message("1 2 3\n1 b 3\n"), HasSubstr("p.xyz:2: expected a number in column 2, found 'b'"));
  EXPECT_THAT(text_message("a b c\n1 2 3\n"), HasSubstr("p.xyz:1: expected numbers x y z, or a header"));
  EXPECT_THAT(text_message("x,y,z,x\n1,2,3,4\n"), HasSubstr("column 'x' is named twice"));
  EXPECT_THAT(text_message("x,y,z\n1,2,\n"), HasSubstr("p.xyz:2: expected a number in column 3, found ''"));
}

TEST_F(PointFile, BinIsLittleEndianFloat32) {
  const auto cloud = read_point_cloud(write("p.bin", floats({1, 2, 3, 4, kNaN, 0, 0, 0, 5, 6, 7, kNaN})));
  ASSERT_TRUE(cloud) << cloud.error().message;
  ASSERT_EQ(cloud->points.size(), 2u);
  EXPECT_EQ(cloud->dropped_non_finite, 1u);
  EXPECT_EQ(cloud->points[0], Eigen::Vector4f(1, 2, 3, 4));
  EXPECT_EQ(cloud->points[1], Eigen::Vector4f(5, 6, 7, 0));
  EXPECT_THAT(message("q.bin", "12345678901234567"), HasSubstr("1 are left over at byte 16"));
  EXPECT_THAT(message("r.bin", ""), HasSubstr("at least one finite point"));
}

TEST_F(PointFile, UnknownExtensionAndMissingFileAreRefused) {
  EXPECT_THAT(message("p.las", "x"), HasSubstr("found extension '.las'"));
  const auto missing = read_point_cloud(directory_.path() / "none.pcd");
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().kind, ErrorKind::no_input);
  EXPECT_EQ(read_point_cloud(directory_.path()).error().kind, ErrorKind::no_input);
}

constexpr const char* kPcdHeader =
    "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z intensity\nSIZE {0} {0} {0} 4\nTYPE F F F F\nCOUNT 1 1 1 1\nWIDTH {1}\n"
    "HEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {1}\nDATA {2}\n";

std::string pcd(int size, int points, const char* data) {
  return fmt::format(fmt::runtime(kPcdHeader), size, points, data);
}

class PclFile : public PointFile {
 protected:
  void SetUp() override {
    const auto cloud = read_point_cloud(write("probe.pcd", pcd(4, 1, "binary") + floats({1, 2, 3, 4})));
    if (!cloud && cloud.error().kind == ErrorKind::unavailable) GTEST_SKIP() << cloud.error().message;
  }
};

TEST_F(PclFile, PcdInAsciiAndBinaryGiveTheSamePoints) {
  const auto ascii = read_point_cloud(write("a.pcd", pcd(4, 2, "ascii") + "1 2 3 4\nnan 0 0 0\n"));
  ASSERT_TRUE(ascii) << ascii.error().message;
  const auto binary = read_point_cloud(write("b.pcd", pcd(4, 2, "binary") + floats({1, 2, 3, 4, kNaN, 0, 0, 0})));
  ASSERT_TRUE(binary) << binary.error().message;
  for (const auto* cloud : {&*ascii, &*binary}) {
    ASSERT_EQ(cloud->points.size(), 1u);
    EXPECT_EQ(cloud->points[0], Eigen::Vector4f(1, 2, 3, 4));
    EXPECT_EQ(cloud->dropped_non_finite, 1u);
  }
}

// PCL would make a point in the origin of each of these lines.
TEST_F(PointFile, AsciiPcdLinesThatAreNoPointsAreRefused) {
  EXPECT_THAT(message("two.pcd", pcd(4, 1, "ascii") + "1 2 3\n"), HasSubstr("two.pcd:12: expected 4 columns"));
  EXPECT_THAT(message("abc.pcd", pcd(4, 1, "ascii") + "a b c d\n"),
              HasSubstr("abc.pcd:12: expected a number in column 1"));
  EXPECT_THAT(message("less.pcd", pcd(4, 2, "ascii") + "1 2 3 4\n"), HasSubstr("expected 2 points, found 1"));
  EXPECT_THAT(message("more.pcd", pcd(4, 1, "ascii") + "1 2 3 4\n1 2 3 4\n"), HasSubstr("expected 1 points, found 2"));
}

TEST_F(PointFile, ArraysOfAnAsciiPcdKeepTheirColumns) {
  const auto cloud =
      read_point_cloud(write("array.pcd",
                             "FIELDS normal x y z\nSIZE 4 4 4 4\nTYPE F F F F\nCOUNT 3 1 1 1\nWIDTH 1\nPOINTS 1\n"
                             "DATA ascii\n9 9 9 1 2 3\n"));
  ASSERT_TRUE(cloud) << cloud.error().message;
  EXPECT_EQ(cloud->points[0], Eigen::Vector4f(1, 2, 3, 0));
}

TEST_F(PointFile, PcdDoublesKeepTheirDigits) {
  const auto cloud = read_point_cloud(write("d.pcd", pcd(8, 1, "ascii") + "515368.123 4918340.456 2322.789 1\n"));
  ASSERT_TRUE(cloud) << cloud.error().message;
  const Eigen::Vector3d point = cloud->points[0].head<3>().cast<double>() + cloud->origin_m;
  EXPECT_NEAR((point - Eigen::Vector3d(515368.123, 4918340.456, 2322.789)).norm(), 0.0, 1e-5);
}

// Compressed data is one LZF block of all x, then all y, then all z; 0x17 announces 24 literal bytes.
TEST_F(PclFile, CompressedPcdIsUnpacked) {
  const std::string header =
      "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 2\nHEIGHT 1\nPOINTS 2\nDATA binary_compressed\n";
  const std::string block = std::string("\x19\0\0\0\x18\0\0\0\x17", 9) + floats({1, 4, 2, 5, 3, 6});
  const auto cloud = read_point_cloud(write("c.pcd", header + block));
  ASSERT_TRUE(cloud) << cloud.error().message;
  ASSERT_EQ(cloud->points.size(), 2u);
  EXPECT_EQ(cloud->points[0], Eigen::Vector4f(1, 2, 3, 0));
  EXPECT_EQ(cloud->points[1], Eigen::Vector4f(4, 5, 6, 0));
  EXPECT_THAT(message("d.pcd", header + block.substr(0, 20)), HasSubstr("compressed bytes that make 24"));
}

// PCL's own header reader would go on into data that looks like a header, and crash.
TEST_F(PclFile, BinaryDataThatLooksLikeAHeaderIsData) {
  std::string data(16, '\0');
  data.replace(0, 7, "FIELDS ");
  const auto cloud = read_point_cloud(write("k.pcd", pcd(4, 1, "binary") + data));
  ASSERT_TRUE(cloud) << cloud.error().message;
  EXPECT_EQ(cloud->points.size(), 1u);
}

TEST_F(PclFile, PlyGivesItsVertices) {
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\n"
      "property float intensity\nend_header\n1 2 3 4\n5 6 7 8\n";
  const auto cloud = read_point_cloud(write("a.ply", ply));
  ASSERT_TRUE(cloud) << cloud.error().message;
  ASSERT_EQ(cloud->points.size(), 2u);
  EXPECT_EQ(cloud->points[1], Eigen::Vector4f(5, 6, 7, 8));
}

TEST_F(PclFile, BrokenFilesAreOneMessageEach) {
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  EXPECT_THAT(message("e.pcd", ""), HasSubstr("expected a PCD header"));
  EXPECT_THAT(message("g.pcd", "garbage\nDATA ascii\n"),
              HasSubstr("g.pcd:1: expected the lines of a PCD header in their order"));
  EXPECT_THAT(message("h.pcd", pcd(4, 2000000000, "binary")), HasSubstr("points in a file of this size"));
  EXPECT_THAT(message("t.pcd", pcd(4, 3, "binary") + floats({1, 2, 3, 4})),
              HasSubstr("found 16: the file is truncated"));
  EXPECT_THAT(message("f.pcd",
                      "VERSION 0.7\nFIELDS a b\nSIZE 4 4\nTYPE F F\nCOUNT 1 1\nWIDTH 1\nHEIGHT 1\nPOINTS 1\n"
                      "DATA ascii\n1 2\n"),
              HasSubstr("a header that names x, y and z, found 'a,b'"));
  EXPECT_THAT(
      message("c.pcd", "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 0 1 1\nWIDTH 1\nPOINTS 1\nDATA ascii\n1 2 3\n"),
      HasSubstr("found field 1 of 4 bytes and count 0"));
  EXPECT_THAT(message("v.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty list uchar int x\nend_header\n1 2\n"),
              HasSubstr("v.ply:4: expected plain properties of a vertex, found a list"));
  EXPECT_THAT(message("e.ply", ""), HasSubstr("expected a PLY header"));
  EXPECT_THAT(message("h.ply", "ply\nformat ascii 1.0\nelement vertex 4000000000\nproperty float x\nend_header\n"),
              HasSubstr("points in a file of this size"));
  EXPECT_THAT(message("t.ply",
                      "ply\nformat binary_little_endian 1.0\nelement vertex 9\nproperty float x\n"
                      "property float y\nproperty float z\nend_header\nabcdefg"),
              HasSubstr("PLY"));
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST(PointCloud, VehicleCloudsHaveTheirPublishedSize) {
  const auto path = test::shared_data("libpointmatcher_clouds/car_cloud400.csv");
  SCREE_SKIP_WITHOUT(path, "libpointmatcher_clouds");
  const auto cloud = read_point_cloud(*path);
  ASSERT_TRUE(cloud) << cloud.error().message;
  std::ifstream stream(*path);
  std::string line;
  std::size_t lines = 0;
  while (std::getline(stream, line)) ++lines;
  EXPECT_EQ(cloud->points.size(), lines - 1) << "one point a line but for the header";
  EXPECT_EQ(cloud->points[0], Eigen::Vector4f(-3.5376f, 0.639553f, -1.37678f, 0.0f))
      << "normals are not read as points";
}

TEST(PointCloud, SurveyBinHasItsPublishedPoints) {
  const auto path = test::shared_data("pdal_lonestar_tls/lone-star_local_xyzi.bin");
  SCREE_SKIP_WITHOUT(path, "pdal_lonestar_tls");
  const auto cloud = read_point_cloud(*path);
  ASSERT_TRUE(cloud) << cloud.error().message;
  EXPECT_EQ(cloud->points.size(), 518862u);
  EXPECT_EQ(cloud->dropped_non_finite, 0u);
}

}  // namespace
}  // namespace scree::io
