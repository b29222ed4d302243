#include "io/npy.hpp"

#include <cmath>
#include <cstring>
#include <fstream>
#include <gtest/gtest.h>
#include <limits>
#include <unistd.h>

namespace scree::io {
namespace {

/// A folder of this process that goes with it.
struct Scratch {
  std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / ("scree_npy_" + std::to_string(getpid()));
  Scratch() { std::filesystem::create_directories(folder); }
  ~Scratch() {
    std::error_code ignored;
    std::filesystem::remove_all(folder, ignored);
  }
};

std::filesystem::path scratch(const std::string& name) {
  static const Scratch scratch;
  return scratch.folder / name;
}

std::span<const std::byte> as_span(const std::string& bytes) {
  return std::as_bytes(std::span(bytes.data(), bytes.size()));
}

/// As numpy.save writes a float32 array of shape (2, 3).
std::string golden() {
  std::string bytes("\x93NUMPY\x01\x00\x76\x00", 10);
  std::string header = "{'descr': '<f4', 'fortran_order': False, 'shape': (2, 3), }";
  header.append(0x76 - 1 - header.size(), ' ');
  bytes += header + "\n";
  for (const float value : {0.0F, 1.0F, 2.0F, 3.0F, 4.0F, 5.0F}) {
    char raw[4];
    std::memcpy(raw, &value, 4);
    bytes.append(raw, 4);
  }
  return bytes;
}

TEST(Npy, WritesTheBytesThatNumpyWrites) {
  Grid<float> grid(2, 3);
  for (std::size_t i = 0; i < grid.size(); ++i) grid[i] = static_cast<float>(i);
  const auto file = scratch("golden.npy");
  ASSERT_TRUE(write_npy(file, grid));
  std::ifstream stream(file, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(stream), {}};
  EXPECT_EQ(bytes, golden());
}

TEST(Npy, ReadsBackEveryBitPatternItWrote) {
  Grid<float> grid(3, 5, -0.0F);
  grid(1, 2) = std::numeric_limits<float>::quiet_NaN();
  grid(2, 4) = std::numeric_limits<float>::infinity();
  grid(0, 0) = std::numeric_limits<float>::denorm_min();
  const auto file = scratch("round.npy");
  ASSERT_TRUE(write_npy(file, grid));
  const auto read = read_npy(file);
  ASSERT_TRUE(read);
  ASSERT_EQ(read->rows(), 3);
  ASSERT_EQ(read->columns(), 5);
  EXPECT_EQ(std::memcmp(read->data(), grid.data(), grid.size() * sizeof(float)), 0);
}

TEST(Npy, OneDimensionIsOneRow) {
  std::string bytes = golden();
  const auto at = bytes.find("(2, 3)");
  bytes.replace(at, 6, "(6, ) ");
  const auto grid = parse_npy(as_span(bytes), "x");
  ASSERT_TRUE(grid) << grid.error().message;
  EXPECT_EQ(grid->rows(), 1);
  EXPECT_EQ(grid->columns(), 6);
}

void expect_bad(std::string bytes, const std::string& in_message) {
  const auto grid = parse_npy(as_span(bytes), "x.npy");
  ASSERT_FALSE(grid);
  EXPECT_EQ(grid.error().kind, ErrorKind::bad_data);
  EXPECT_NE(grid.error().message.find("x.npy: byte "), std::string::npos) << grid.error().message;
  EXPECT_NE(grid.error().message.find(in_message), std::string::npos) << grid.error().message;
}

TEST(Npy, SaysWhatIsWrong) {
  const auto with = [](const std::string& from, const std::string& to) {
    std::string bytes = golden();
    return bytes.replace(bytes.find(from), from.size(), to);
  };
  expect_bad("", "magic");
  expect_bad("PK\x03\x04", "magic");
  expect_bad(golden().substr(0, 8), "end of the file");
  expect_bad(golden().substr(0, 40), "a header of 118 bytes");
  expect_bad(golden().substr(0, golden().size() - 1), "2 × 3 float32");
  expect_bad(golden() + "surplus.", "2 × 3 float32");
  expect_bad(with("<f4", "<f8"), "descr '<f4'");
  expect_bad(with("False", "True "), "fortran_order False");
  expect_bad(with("(2, 3)", "(2,-3)"), "shape");
  expect_bad(with("(2, 3)", "(2,1,3"), "shape");
  expect_bad(with("'shape'", "'shade'"), "found nothing");
}

TEST(Npy, MissingFileIsNoInputAndMissingFolderCannotBeCreated) {
  const auto read = read_npy(scratch("none/none.npy"));
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().kind, ErrorKind::no_input);
  const auto written = write_npy(scratch("none/none.npy"), Grid<float>(1, 1));
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().kind, ErrorKind::cannot_create);
}

}  // namespace
}  // namespace scree::io
