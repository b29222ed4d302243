// Fault scripts, and what the faults do to frames.

#include "drivers/fault_script.hpp"

#include <algorithm>
#include <gtest/gtest.h>

#include "drivers/frame_damage.hpp"
#include "drivers/frame_stream_decoder.hpp"
#include "drivers/little_endian.hpp"
#include "tests/drivers/stream_support.hpp"
#include "tests/support/temporary_folder.hpp"

namespace scree::drivers {
namespace {

using std::chrono::milliseconds;

TEST(FaultScript, EveryActionIsRead) {
  const auto faults = parse_fault_script(
      "# what goes wrong\n"
      "0 unplug 1.5\n"
      "\n"
      "  1\tstall   # until the host clears it\r\n"
      "1 babble\n"
      "2.25 corrupt 3\n"
      "3 slow 2.5 4\n"
      "4 wrong_geometry 1\n"
      "5 freeze 0.001",
      "f");
  ASSERT_TRUE(faults) << faults.error().message;
  ASSERT_EQ(faults->size(), 7u);
  for (std::size_t i = 0; i < faults->size(); ++i) EXPECT_EQ((*faults)[i].kind, static_cast<FaultKind>(i));
  EXPECT_EQ((*faults)[0].lasts, milliseconds(1500));
  EXPECT_EQ((*faults)[1].at, milliseconds(1000));
  EXPECT_EQ((*faults)[1].line, 4);
  EXPECT_EQ((*faults)[3].at, milliseconds(2250));
  EXPECT_EQ((*faults)[3].frames, 3u);
  EXPECT_EQ((*faults)[4].factor, 2.5);
  EXPECT_EQ((*faults)[4].lasts, milliseconds(4000));
  EXPECT_EQ((*faults)[6].lasts, milliseconds(1));
}

TEST(FaultScript, AnEmptyOneHasNoFaults) {
  for (const char* text : {"", "\n\n", "# nothing", " \t \n#\n"}) {
    const auto faults = parse_fault_script(text, "f");
    ASSERT_TRUE(faults) << faults.error().message;
    EXPECT_TRUE(faults->empty()) << text;
  }
}

TEST(FaultScript, AnErrorNamesPlaceExpectationAndFinding) {
  const auto expect = [](const std::string& text, const std::string& place, const std::string& expected,
                         const std::string& found) {
    const auto faults = parse_fault_script(text, "dir/f.txt");
    ASSERT_FALSE(faults) << text;
    EXPECT_EQ(faults.error().kind, ErrorKind::bad_data);
    const std::string& message = faults.error().message;
    EXPECT_TRUE(message.starts_with("dir/f.txt:" + place + ": expected ")) << message;
    EXPECT_NE(message.find(expected), std::string::npos) << message;
    EXPECT_NE(message.find("found " + found), std::string::npos) << message;
  };
  expect("soon unplug 1", "1", "a time in seconds", "'soon'");
  expect("-1 unplug 1", "1", "0 … 86400", "'-1'");
  expect("\n1", "2", "unplug, stall, babble, corrupt, slow, wrong_geometry, freeze", "'nothing'");
  expect("1 explode", "1", "one of unplug, stall", "'explode'");
  expect("1 unplug", "1", "'unplug SECONDS'", "'0 arguments'");
  expect("1 stall 2", "1", "'stall'", "'1 arguments'");
  expect("1 slow 2", "1", "'slow FACTOR SECONDS'", "'1 arguments'");
  expect("1 slow 0 1", "1", "a factor", "'0'");
  expect("1 slow nan 1", "1", "a factor", "'nan'");
  expect("1 corrupt 0", "1", "a number of frames", "'0'");
  expect("1 corrupt 1.5", "1", "a number of frames", "'1.5'");
  expect("1 freeze 0", "1", "above 0", "'0'");
  expect("1 freeze 1e9", "1", "at most 86400", "'1e9'");
  expect("# x\n2 stall\n1.5 stall", "3", "not before that of line 2, 2 s", "1.5 s");
}

TEST(FaultScript, AFileThatIsNotThereIsNoInput) {
  const test::TemporaryFolder folder;
  for (const auto& path : {folder.path() / "none.txt", folder.path()}) {
    const auto faults = load_fault_script(path);
    ASSERT_FALSE(faults);
    EXPECT_EQ(faults.error().kind, ErrorKind::no_input);
    EXPECT_NE(faults.error().message.find(path.string()), std::string::npos);
  }
}

TEST(FrameDamage, FlippedBytesAreSpreadOverTheWhole) {
  std::vector<std::uint8_t> bytes(800, 0x0F);
  flip_bytes(bytes, 3);
  for (int eighth = 0; eighth < 8; ++eighth)
    EXPECT_EQ(std::count(bytes.begin() + 100 * eighth, bytes.begin() + 100 * (eighth + 1), 0xF0), 1) << eighth;
  std::vector<std::uint8_t> other(800, 0x0F), again(800, 0x0F);
  flip_bytes(other, 4);
  flip_bytes(again, 3);
  EXPECT_NE(other, bytes);
  EXPECT_EQ(again, bytes);
  std::vector<std::uint8_t> small(3), none;
  flip_bytes(small, 1);
  flip_bytes(none, 1);
}

TEST(FrameDamage, AFrameUnderAnotherGeometryHasGoodCrcsAndIsRefusedForItsSize) {
  const auto encoder = stream::test_encoder();
  const auto message = stream::encoded(encoder, stream::test_frame(7));
  auto other = stream::test_scanner();
  other.sensor.projection.rows /= 2;
  other.sensor.projection.trusted_rows = other.sensor.projection.rows;
  const auto lie = with_other_geometry(message, stream::encode_geometry(other));

  stream::Decoder decoder;
  std::span<const std::uint8_t> rest(lie);
  const auto geometry = decoder.next(rest);
  ASSERT_TRUE(geometry);
  EXPECT_EQ(geometry->header.type, stream::MessageType::geometry);
  const auto told = stream::decode_geometry(geometry->payload, 0);
  ASSERT_TRUE(told) << told.error().message;
  EXPECT_EQ(told->sensor.projection.rows, other.sensor.projection.rows);
  const std::uint32_t id = geometry->header.geometry_id;
  const auto frame = decoder.next(rest);
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->header.type, stream::MessageType::frame);
  EXPECT_EQ(frame->header.sequence, 7u);
  EXPECT_EQ(frame->header.geometry_id, id);
  EXPECT_EQ(read_number<std::uint16_t>(frame->payload.data()), stream::test_scanner().sensor.projection.rows);
  EXPECT_EQ(decoder.counters().bytes_skipped, 0u);
}

}  // namespace
}  // namespace scree::drivers
