#include "drivers/depth_image.hpp"

#include <algorithm>
#include <array>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/shared_data.hpp"

namespace scree::drivers {
namespace {

using testing::HasSubstr;
using Bytes = std::vector<std::uint8_t>;

Bytes image(const std::string& header, std::initializer_list<std::uint8_t> payload) {
  Bytes bytes(header.begin(), header.end());
  bytes.insert(bytes.end(), payload);
  return bytes;
}

std::string message(const Bytes& bytes) {
  Grid<std::uint16_t> raw;
  const auto status = parse_depth_image(bytes, "d.pgm", raw);
  if (status) return "accepted";
  EXPECT_EQ(status.error().kind, ErrorKind::bad_data);
  EXPECT_THAT(status.error().message, HasSubstr("d.pgm: expected"));
  return status.error().message;
}

TEST(DepthImage, SamplesAreBigEndianAndRowMajor) {
  Grid<std::uint16_t> raw;
  ASSERT_TRUE(parse_depth_image(image("P5 3 1 65535\n", {0x01, 0x02, 0xFF, 0xFE, 0, 7}), "d.pgm", raw));
  EXPECT_EQ(raw.rows(), 1);
  EXPECT_EQ(raw.columns(), 3);
  EXPECT_EQ(raw(0, 0), 0x0102);
  EXPECT_EQ(raw(0, 1), 0xFFFE);
  EXPECT_EQ(raw(0, 2), 7);
}

TEST(DepthImage, CommentsInTheHeaderAreSkipped) {
  Grid<std::uint16_t> raw;
  ASSERT_TRUE(parse_depth_image(image("P5# a\n#b\n1 # 9 9\n 2\n4095\n", {0, 1, 0, 2}), "d.pgm", raw));
  EXPECT_EQ(raw.rows(), 2);
  EXPECT_EQ(raw(1, 0), 2);
}

TEST(DepthImage, WhatIsNoSixteenBitImageIsRefused) {
  EXPECT_THAT(message({}), HasSubstr("a binary PGM"));
  EXPECT_THAT(message(image("P2 1 1 65535\n", {0, 0})), HasSubstr("a binary PGM"));
  EXPECT_THAT(message(image("P5 0 1 65535\n", {})), HasSubstr("a width of 1..16384"));
  EXPECT_THAT(message(image("P5 1 99999 65535\n", {})), HasSubstr("a height of 1..16384"));
  EXPECT_THAT(message(image("P5 1 1 255\n", {0})), HasSubstr("maxval of 256..65535"));
  EXPECT_THAT(message(image("P5 1 1 65536\n", {0, 0})), HasSubstr("maxval of 256..65535"));
  EXPECT_THAT(message(image("P5 1 1 65535", {})), HasSubstr("one blank behind maxval"));
  EXPECT_THAT(message(image("P5 1 2 65535\n", {0, 0, 0})),
              HasSubstr("= 4 bytes from byte 13, found 3: the file is truncated"));
  EXPECT_THAT(message(image("P5 1 1 65535\n", {0, 0, 0})), HasSubstr("= 2 bytes from byte 13, found 3"));
  EXPECT_THAT(message(image("P5 1 2 1000\n", {0, 0, 3, 0xE9})), HasSubstr("up to maxval 1000, found 1001 at byte 14"));
}

TEST(DepthImage, EncodedImageReadsBack) {
  Grid<std::uint16_t> raw(3, 5);
  for (std::size_t i = 0; i < raw.size(); ++i) raw[i] = static_cast<std::uint16_t>(i * 4369);
  const auto bytes = encode_depth_image(raw);
  ASSERT_TRUE(bytes);
  Grid<std::uint16_t> back;
  ASSERT_TRUE(parse_depth_image(*bytes, "d.pgm", back));
  EXPECT_EQ(back, raw);
  EXPECT_FALSE(encode_depth_image({}));
}

// Shares of invalid pixels as the data's own description gives them.
TEST(DepthImage, KinectFramesHaveTheirPublishedShareOfHoles) {
  for (int i = 1; i <= 5; ++i) {
    const std::string name = "rgbd_kinect_slambook2/depth_" + std::to_string(i) + ".pgm";
    const auto path = test::shared_data(name);
    SCREE_SKIP_WITHOUT(path, name);
    const auto raw = read_depth_image(*path);
    ASSERT_TRUE(raw) << raw.error().message;
    EXPECT_EQ(raw->rows(), 480);
    EXPECT_EQ(raw->columns(), 640);
    const double holes = static_cast<double>(std::count(raw->begin(), raw->end(), 0)) / (480.0 * 640.0);
    EXPECT_GT(holes, 0.27);  // 27.4 % in the third frame
    EXPECT_LT(holes, 0.325);
  }
}

TEST(DepthImage, RealsenseFramesHaveTheirPublishedShareOfValidPixels) {
  const std::array<std::pair<const char*, double>, 2> images{
      {{"one_cloud_depth_z16_848x480.pgm", 0.454}, {"hand_depth_z16_848x480.pgm", 0.510}}};
  for (const auto& [name, share] : images) {
    const auto path = test::shared_data(std::string("realsense_d435_bag/") + name);
    SCREE_SKIP_WITHOUT(path, name);
    const auto raw = read_depth_image(*path);
    ASSERT_TRUE(raw) << raw.error().message;
    EXPECT_EQ(raw->columns(), 848);
    const double valid = 1.0 - static_cast<double>(std::count(raw->begin(), raw->end(), 0)) / (848.0 * 480.0);
    EXPECT_NEAR(valid, share, 0.0005);
  }
}

}  // namespace
}  // namespace scree::drivers
