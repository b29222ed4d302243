#include "drivers/perceptron_file.hpp"

#include <cstring>
#include <fmt/format.h>
#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/shared_data.hpp"

namespace scree::drivers {
namespace {

using testing::HasSubstr;
using Bytes = std::vector<std::uint8_t>;

Bytes bytes_of(const std::string& text) {
  return {text.begin(), text.end()};
}

/// A USF file of 2 × 3 with raw numbers 0, 1, 2, … and a chosen line end.
Bytes small_usf(const std::string& end = "\n", std::string between = {}) {
  std::string text = "rows: 2" + end + "columns: 3" + end;
  for (int line = 3; line <= 10; ++line) text += fmt::format("opaque {}", line) + end;
  text += end + between;
  Bytes bytes = bytes_of(text);
  for (int i = 0; i < 6; ++i) bytes.insert(bytes.end(), {0, 0, 0, static_cast<std::uint8_t>(i)});
  return bytes;
}

Status parse(const Bytes& bytes, RangeFile& out, RangeFileOptions options = {}) {
  return parse_range_file(bytes, "x.perc", options, out);
}

std::string message(const Bytes& bytes, RangeFileOptions options = {}) {
  RangeFile out;
  const auto status = parse(bytes, out, options);
  if (status) return "accepted";
  EXPECT_EQ(status.error().kind, ErrorKind::bad_data);
  EXPECT_THAT(status.error().message, HasSubstr("x.perc: expected"));
  return status.error().message;
}

TEST(PerceptronFile, UsfWordsAreBigEndianWithTheRangeInTheLowTwelveBits) {
  Bytes bytes = small_usf();
  const std::size_t payload = bytes.size() - 24;
  const std::array<std::uint8_t, 4> word{0xAB, 0xCD, 0xEF, 0x12};
  std::copy(word.begin(), word.end(), bytes.begin() + static_cast<std::ptrdiff_t>(payload));
  RangeFile file;
  ASSERT_TRUE(parse(bytes, file));
  EXPECT_EQ(file.layout, RangeFileLayout::usf);
  EXPECT_EQ(file.raw.rows(), 2);
  EXPECT_EQ(file.raw.columns(), 3);
  EXPECT_EQ(file.raw(0, 0), 0xF12);
  EXPECT_EQ(file.raw(1, 2), 5);
  EXPECT_TRUE(file.reflectance.empty());
  EXPECT_EQ(file.header[0], "rows: 2");
  EXPECT_EQ(file.header[9], "opaque 10");
  ASSERT_TRUE(parse(bytes, file, {.reflectance_shift = 12}));
  EXPECT_EQ(file.reflectance(0, 0), 0xCDE);
  EXPECT_EQ(file.raw(0, 0), 0xF12) << "range never depends on the reflectance";
  ASSERT_TRUE(parse(bytes, file, {.reflectance_shift = 16}));
  EXPECT_EQ(file.reflectance(0, 0), 0xBCD);
}

TEST(PerceptronFile, CarriageReturnsAreAccepted) {
  RangeFile file;
  ASSERT_TRUE(parse(small_usf("\r\n"), file));
  EXPECT_EQ(file.raw(1, 1), 4);
  EXPECT_EQ(file.header[9], "opaque 10");
}

TEST(PerceptronFile, KeysDoNotMatterPositionsDo) {
  Bytes bytes = small_usf();
  bytes[0] = 'z';
  RangeFile file;
  EXPECT_TRUE(parse(bytes, file));
  EXPECT_THAT(message(bytes_of("x:1\n\n")), HasSubstr("'<key>: <columns>'"));
}

TEST(PerceptronFile, PayloadStartingWithLineEndsIsNotMistakenForTheHeader) {
  Bytes bytes = small_usf();
  std::fill(bytes.end() - 24, bytes.end(), std::uint8_t{'\n'});
  RangeFile file;
  ASSERT_TRUE(parse(bytes, file));
  EXPECT_EQ(file.raw(0, 0), 0xA0A);
}

TEST(PerceptronFile, TruncatedFileIsRefusedAtEveryLength) {
  const Bytes whole = small_usf();
  for (std::size_t size = 0; size < whole.size(); ++size)
    EXPECT_NE(message(Bytes(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size))), "accepted") << size;
  EXPECT_EQ(message(Bytes(whole.begin(), whole.end() - 1)),
            "x.perc: expected 2 x 3 words of 4 bytes = 24 bytes from byte 93, found 23: the file is truncated");
}

TEST(PerceptronFile, OversizedFileIsRefused) {
  Bytes bytes = small_usf();
  bytes.push_back(0);
  EXPECT_THAT(message(bytes), HasSubstr("found 25: 1 bytes too many"));
}

TEST(PerceptronFile, SidesOutsideOneTo4096AreRefused) {
  for (const char* value : {"0", "-3", "4097", "99999999999999", "2x", "", "2.5", "nan"}) {
    std::string text = fmt::format("rows: {}\ncolumns: 3\n\n\n\n\n\n\n\n\n\n", value);
    EXPECT_THAT(message(bytes_of(text)), HasSubstr("with rows in 1..4096")) << value;
  }
}

TEST(PerceptronFile, GarbageHeadersAreRefused) {
  EXPECT_THAT(message({}), HasSubstr("found 0 bytes"));
  EXPECT_THAT(message(bytes_of("no colon here\n")), HasSubstr("without a header"));
  EXPECT_THAT(message(bytes_of("a:" + std::string(5000, 'b'))), HasSubstr("10 header lines within the first 4096"));
  Bytes unended = bytes_of("rows: 2\ncolumns: 3\n" + std::string(8, '\n'));
  unended.insert(unended.end(), 24, 0);
  EXPECT_THAT(message(unended), HasSubstr("expected an empty line behind the 10 header lines"));
  Bytes binary(1000, 0xFF);
  EXPECT_THAT(message(binary), HasSubstr("found 1000 bytes without a header"));
}

TEST(PerceptronFile, LenientAcceptsPrintableSurplusOnlyAndWarns) {
  const Bytes surplus = small_usf("\n", "written by hand\n");
  EXPECT_THAT(message(surplus), HasSubstr("16 bytes too many"));
  RangeFile file;
  ASSERT_TRUE(parse(surplus, file, {.lenient = true}));
  EXPECT_EQ(file.raw(1, 2), 5);
  EXPECT_THAT(file.warning, HasSubstr("16 bytes of text at byte 93"));
  ASSERT_TRUE(parse(small_usf(), file, {.lenient = true}));
  EXPECT_EQ(file.warning, "");

  EXPECT_THAT(message(small_usf("\n", std::string(4097, 'a')), {.lenient = true}), HasSubstr("4097 bytes too many"));
  EXPECT_THAT(message(small_usf("\n", "\x01"), {.lenient = true}), HasSubstr("found code 1 at byte 93"));
  Bytes truncated = surplus;
  truncated.resize(93 + 23);
  EXPECT_THAT(message(truncated, {.lenient = true}), HasSubstr("truncated"));
}

// Text and payload of a cut file slide into each other; the shortest cut that strict reading could not see either is
// the whole text.
TEST(PerceptronFile, LenientNeverAcceptsATruncatedFile) {
  Bytes bytes = small_usf("\n", "two lines\nof text\n");
  for (int cut = 1; cut < 18; ++cut) {
    bytes.pop_back();
    EXPECT_THAT(message(bytes, {.lenient = true}), HasSubstr("truncated")) << cut;
  }
}

TEST(PerceptronFile, HeaderlessFilesAreToldApartBySize) {
  Bytes words(262144, 0);
  words[7] = 9;
  words[6] = 0xF1;
  RangeFile file;
  ASSERT_TRUE(parse(words, file));
  EXPECT_EQ(file.layout, RangeFileLayout::cmu_words);
  EXPECT_EQ(file.raw.rows(), 256);
  EXPECT_EQ(file.raw(0, 1), 0x109);

  Bytes ranges(131072, 0);
  ranges[2] = 0x0F;
  ranges[3] = 0xFE;
  ASSERT_TRUE(parse(ranges, file));
  EXPECT_EQ(file.layout, RangeFileLayout::cmu_ranges);
  EXPECT_EQ(file.raw(0, 1), 0xFFE);
  EXPECT_EQ(file.header[0], "");

  ranges[131070] = 0x10;
  EXPECT_THAT(message(ranges), HasSubstr("expected 2-byte ranges 0..4095, found 4096 at byte 131070"));
  words.pop_back();
  EXPECT_THAT(message(words), HasSubstr("found 262143 bytes"));
}

TEST(PerceptronFile, UsfFileCutToTheSizeOfACmuFrameIsNoCmuFrame) {
  RangeFile usf;
  usf.raw.assign(512, 512, 7);
  auto bytes = encode_range_file(usf);
  ASSERT_TRUE(bytes);
  bytes->resize(262144);
  EXPECT_THAT(message(*bytes), HasSubstr("truncated"));
}

TEST(PerceptronFile, EncodedFilesReadBack) {
  for (const auto layout : {RangeFileLayout::usf, RangeFileLayout::cmu_words, RangeFileLayout::cmu_ranges}) {
    RangeFile file;
    file.layout = layout;
    file.header[4] = layout == RangeFileLayout::usf ? "kept as it is" : "";
    file.raw.assign(256, 256, 0);
    file.reflectance.assign(256, 256, 0);
    for (std::size_t i = 0; i < file.raw.size(); ++i) {
      file.raw[i] = static_cast<std::uint16_t>((i * 2654435761u) >> 20 & 0xFFF);
      file.reflectance[i] = static_cast<std::uint16_t>(i & 0xFFF);
    }
    const int shift = layout == RangeFileLayout::cmu_ranges ? 0 : 16;
    const auto bytes = encode_range_file(file, shift);
    ASSERT_TRUE(bytes) << bytes.error().message;
    RangeFile back;
    ASSERT_TRUE(parse(*bytes, back, {.reflectance_shift = shift}));
    EXPECT_EQ(back.layout, layout);
    EXPECT_EQ(back.raw, file.raw);
    if (shift != 0) {
      EXPECT_EQ(back.reflectance, file.reflectance);
    }
    EXPECT_EQ(back.header[4], file.header[4]);
  }
}

TEST(PerceptronFile, WriterRefusesWhatTheFormatCannotHold) {
  RangeFile file;
  EXPECT_FALSE(encode_range_file(file));
  file.raw.assign(2, 2, 4096);
  EXPECT_THAT(encode_range_file(file).error().message, HasSubstr("found 4096 in row 0, column 0"));
  file.raw.assign(2, 2, 1);
  file.layout = RangeFileLayout::cmu_words;
  EXPECT_THAT(encode_range_file(file).error().message, HasSubstr("expected 256 x 256"));
  file.layout = RangeFileLayout::usf;
  EXPECT_THAT(encode_range_file(file, 12).error().message, HasSubstr("expected a reflectance of 2 x 2"));
}

TEST(PerceptronFile, MissingFileIsNoInput) {
  const auto file = read_range_file("/nonexistent/x.perc");
  ASSERT_FALSE(file);
  EXPECT_EQ(file.error().kind, ErrorKind::no_input);
}

// The file's own description: distance along the ray has an error sd below 0.9 cm with tails to 7 cm where there is a
// surface; counts are 0.20236 cm. The constant part of the range law is the projection's business: here only that the
// raw numbers follow the truth pixel by pixel.
TEST(PerceptronFile, SyntheticFileFollowsItsTruth) {
  const auto path = test::shared_data("perceptron_SYNTHETIC/synthetic_msh.perc");
  SCREE_SKIP_WITHOUT(path, "perceptron_SYNTHETIC");
  const auto file = read_range_file(*path, {.reflectance_shift = 12});
  ASSERT_TRUE(file) << file.error().message;
  ASSERT_EQ(file->raw.rows(), 512);
  ASSERT_EQ(file->raw.columns(), 512);
  std::vector<float> truth_cm(file->raw.size());
  std::ifstream stream(path->parent_path() / "synthetic_msh.truth_t_cm.f32", std::ios::binary);
  ASSERT_TRUE(stream.read(reinterpret_cast<char*>(truth_cm.data()), static_cast<std::streamsize>(4 * truth_cm.size())));
  double sky_reflectance = 0.0, ground_reflectance = 0.0;
  std::size_t sky = 0, close = 0, ground = 0;
  for (std::size_t i = 0; i < truth_cm.size(); ++i) {
    if (truth_cm[i] <= 0.0f) {
      ++sky;
      sky_reflectance += file->reflectance[i];
      continue;
    }
    ++ground;
    ground_reflectance += file->reflectance[i];
    // 168.02 cm is the centre ray's distance at raw 0; the geometry moves it by a few cm over the image.
    if (std::abs(file->raw[i] * 0.20236 + 168.02 - static_cast<double>(truth_cm[i])) < 15.0) ++close;
  }
  EXPECT_NEAR(static_cast<double>(sky) / static_cast<double>(truth_cm.size()), 0.105, 0.001);
  EXPECT_GT(static_cast<double>(close) / static_cast<double>(ground), 0.999);
  EXPECT_LT(sky_reflectance / static_cast<double>(sky), 0.2 * ground_reflectance / static_cast<double>(ground));
}

}  // namespace
}  // namespace scree::drivers
