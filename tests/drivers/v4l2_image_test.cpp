// What is pure in the V4L2 source.

#include "drivers/v4l2_image.hpp"

#include <cerrno>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <vector>

#include "drivers/v4l2_capabilities.hpp"

namespace scree::drivers::v4l2 {
namespace {

using namespace std::chrono_literals;

TEST(V4l2Formats, AreFoundByNameAndByFourcc) {
  EXPECT_EQ(fourcc_of("Z16 "), 0x2036315Au);  // v4l2_fourcc('Z', '1', '6', ' ')
  ASSERT_NE(range_format("Y12"), nullptr);
  EXPECT_EQ(range_format("Y12"), range_format(0x20323159u));
  EXPECT_EQ(range_format("Y12")->mask, 0x0FFF);
  EXPECT_EQ(range_format("z16"), nullptr);
  EXPECT_EQ(range_format(fourcc_of("YUYV")), nullptr);
  EXPECT_EQ(fourcc_text(fourcc_of("Z16 ")), "Z16");
  EXPECT_EQ(fourcc_text(0x01020304), "0x01020304");
  EXPECT_EQ(fourcc_text(0x20202020), "0x20202020");
}

TEST(V4l2Formats, TheFirstThatIsOfferedIsChosenUnlessOneIsAskedFor) {
  const std::vector<std::uint32_t> offered{fourcc_of("YUYV"), fourcc_of("Y12 "), fourcc_of("Y16 ")};
  EXPECT_EQ(choose_format(nullptr, offered), range_format("Y16"));  // our order, not the device's
  EXPECT_EQ(choose_format(range_format("Y12"), offered), range_format("Y12"));
  EXPECT_EQ(choose_format(range_format("Z16"), offered), nullptr);
  EXPECT_EQ(choose_format(nullptr, std::span(offered).first(1)), nullptr);
}

TEST(V4l2Image, CountsAreTheWordsWithoutPaddingAndWithoutBitsThatAreNone) {
  const Image image{range_format("Y12"), 2, 3, 8, 0.0};
  const std::vector<std::uint8_t> bytes{0x01, 0xF0, 0xFF, 0xFF, 0x34, 0x12, 0xEE, 0xEE,  //
                                        0x00, 0x00, 0xFF, 0x0F, 0x00, 0x10};
  ASSERT_EQ(image.bytes(), bytes.size());
  Grid<std::uint16_t> counts;
  read_counts(bytes, image, counts);
  EXPECT_THAT(std::vector(counts.begin(), counts.end()), testing::ElementsAre(0x001, 0xFFF, 0x234, 0, 0xFFF, 0));
  const Image sixteen{range_format("Z16"), 2, 3, 8, 0.0};
  read_counts(bytes, sixteen, counts);
  EXPECT_THAT(std::vector(counts.begin(), counts.end()),
              testing::ElementsAre(0xF001, 0xFFFF, 0x1234, 0, 0x0FFF, 0x1000));
}

/// Clocks that differ by `offset` at a monotonic moment.
ClockReading at(Duration monotonic, Duration offset) {
  return {MonotonicTime(monotonic), Time(monotonic + offset)};
}

TEST(V4l2Stamps, AreUnixTimesByTheOffsetOfTheClocksAtTheFrame) {
  StampClock clock;
  EXPECT_EQ(clock.unix_time(MonotonicTime(100s), at(100s + 20ms, 1000s)), Time(1100s));
  EXPECT_EQ(clock.unix_time(MonotonicTime(100s + 33ms), at(100s + 50ms, 1000s + 10us)), Time(1100s + 33ms + 10us));
  EXPECT_EQ(clock.unix_time(MonotonicTime(100s + 66ms), at(100s + 80ms, 1500s)), Time(1600s + 66ms));  // set forward
  EXPECT_EQ(clock.held(), 0u);
  EXPECT_EQ(clock.implausible(), 0u);
}

TEST(V4l2Stamps, GoOnWhenTheClockIsSetBackUntilItHasCaughtUp) {
  StampClock clock;
  clock.unix_time(MonotonicTime(100s), at(100s, 1000s));
  EXPECT_EQ(clock.unix_time(MonotonicTime(101s), at(101s, 990s)), Time(1101s));
  EXPECT_EQ(clock.unix_time(MonotonicTime(102s), at(102s, 990s)), Time(1102s));
  EXPECT_EQ(clock.held(), 2u);
  EXPECT_EQ(clock.unix_time(MonotonicTime(103s), at(103s, 1001s)), Time(1104s));  // set right again
  EXPECT_EQ(clock.unix_time(MonotonicTime(104s), at(104s, 1000s + 500ms)), Time(1104s + 500ms));
  EXPECT_EQ(clock.held(), 2u);
}

TEST(V4l2Stamps, StrictlyIncreaseAlsoWhenTheDriversDoNot) {
  StampClock clock;
  const Time first = clock.unix_time(MonotonicTime(100s), at(100s, 1000s));
  EXPECT_EQ(clock.unix_time(MonotonicTime(100s), at(100s + 10ms, 1000s)), first + 1ns);
  EXPECT_EQ(clock.unix_time(MonotonicTime(99s), at(100s + 20ms, 1000s)), first + 2ns);
}

TEST(V4l2Stamps, OfTheFutureOrOfLongAgoAreNotBelieved) {
  StampClock clock;
  EXPECT_EQ(clock.unix_time(MonotonicTime(0s), at(100s, 1000s)), Time(1100s));
  EXPECT_EQ(clock.unix_time(MonotonicTime(101s + 1ns), at(101s, 1000s)), Time(1101s));
  EXPECT_EQ(clock.unix_time(MonotonicTime(101s + 500ms), at(111s + 500ms, 1000s)), Time(1101s + 500ms));  // 10 s
  EXPECT_EQ(clock.implausible(), 2u);
}

TEST(V4l2Stamps, TheClocksOfAReadingAreThoseOfThisMachine) {
  const auto before = std::chrono::system_clock::now();
  const auto reading = read_clocks();
  EXPECT_LE(before, reading.unix);
  EXPECT_LE(reading.unix, std::chrono::system_clock::now());
  EXPECT_LE(reading.monotonic, MonotonicClock::now());
}

TEST(V4l2Sequence, GapsAreCountedWithinOneRunAlone) {
  SequenceCounter counter;
  counter.note(7);
  EXPECT_EQ(counter.number(), 0u);
  counter.note(8);
  counter.note(11);
  EXPECT_EQ(counter.number(), 4u);
  EXPECT_EQ(counter.missing(), 2u);
  counter.restart();
  counter.note(3);
  EXPECT_EQ(counter.number(), 5u);
  EXPECT_EQ(counter.missing(), 2u);
}

TEST(V4l2Sequence, WrapsAndBelievesNoStepBack) {
  SequenceCounter counter;
  counter.note(0xFFFF'FFFEu);
  counter.note(1);
  EXPECT_EQ(counter.missing(), 2u);
  counter.note(1);
  counter.note(0);
  EXPECT_EQ(counter.missing(), 2u);
  EXPECT_EQ(counter.number(), 5u);
}

TEST(V4l2Handle, SaysWhatHelpsWhereANodeMayNotBeOpened) {
  const Error denied = open_error("/dev/video0", EACCES);
  EXPECT_EQ(denied.kind, ErrorKind::unavailable);
  EXPECT_THAT(denied.message, testing::HasSubstr("group 'video', or install launch/99-scree.rules"));
  EXPECT_EQ(open_error("/dev/video0", ENOENT).kind, ErrorKind::no_input);
  EXPECT_EQ(call_error("/dev/video0", "VIDIOC_DQBUF", ENODEV).kind, ErrorKind::no_input);
  EXPECT_THAT(call_error("/dev/video0", "VIDIOC_S_FMT", EBUSY).message, testing::HasSubstr("another program"));
}

TEST(V4l2Handle, AFileThatIsNoDeviceIsSaidToBeNone) {
  const auto handle = Handle::open("/dev/null");
  ASSERT_TRUE(handle);
  const auto told = read_capabilities(*handle, "/dev/null");
  ASSERT_FALSE(told);
  EXPECT_EQ(told.error().message, "'/dev/null': expected a V4L2 device, found something else");
}

}  // namespace
}  // namespace scree::drivers::v4l2
