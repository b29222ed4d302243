// The list `sources:` of a configuration.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "config/loader.hpp"

namespace scree::config {
namespace {

using ::testing::HasSubstr;

constexpr const char* kTwo = R"(
sources:
  - kind: usb
    serial: A1
    sensor: {range_max_m: 12}
  - name: camera
    kind: v4l2
    device: /dev/video3
    rate_hz: 30
    sensor: {projection: pinhole, parameters: {fx_px: 9, fy_px: 9, cx_px: 4, cy_px: 4}}
pose: {source: static}
)";

TEST(Sources, EachHasItsOwnKeysNameAndSensor) {
  const auto settings = parse_settings(kTwo, "test");
  ASSERT_TRUE(settings) << settings.error().message;
  const auto sources = settings->all_sources();
  ASSERT_EQ(sources.size(), 2u);
  EXPECT_EQ(sources[0].kind, SourceKind::usb);
  EXPECT_EQ(sources[0].serial, "A1");
  EXPECT_EQ(sources[0].name_at(0), "source0");
  EXPECT_EQ(sources[0].sensor_given, std::vector<std::string>{"range_max_m"});
  EXPECT_EQ(sources[0].sensor->filter.range_max_m, 12.0);
  EXPECT_TRUE(sources[1].has_whole_sensor());
  EXPECT_EQ(sources[1].name_at(1), "camera");
  EXPECT_EQ(sources[1].device, "/dev/video3");
  EXPECT_EQ(sources[1].rate_hz, 30.0);
}

TEST(Sources, TheDumpReadsBackToTheSame) {
  const auto settings = parse_settings(kTwo, "test");
  ASSERT_TRUE(settings);
  const std::string dumped = dump_settings(*settings);
  EXPECT_THAT(dumped, HasSubstr("sources:\n  - kind: usb\n"));
  const auto again = parse_settings(dumped, "dump");
  ASSERT_TRUE(again) << again.error().message << "\n" << dumped;
  EXPECT_EQ(dump_settings(*again), dumped);
}

TEST(Sources, WithoutAListTheOneSourceHasTheSensorBesideIt) {
  const auto settings = parse_settings("source: {kind: usb}\nsensor: {range_max_m: 7}\n", "test");
  ASSERT_TRUE(settings);
  const auto sources = settings->all_sources();
  ASSERT_EQ(sources.size(), 1u);
  EXPECT_EQ(sources[0].kind, SourceKind::usb);
  EXPECT_EQ(sources[0].sensor->filter.range_max_m, 7.0);
}

TEST(Sources, AssignmentsReachIntoTheList) {
  const auto settings = parse_settings(kTwo, "test", {"sources[1].device=/dev/video0", "sources[2].kind=usb"});
  ASSERT_TRUE(settings) << settings.error().message;
  ASSERT_EQ(settings->sources.size(), 3u);
  EXPECT_EQ(settings->sources[1].device, "/dev/video0");
  EXPECT_EQ(settings->sources[2].kind, SourceKind::usb);
}

std::string fault(const std::string& text, const std::vector<std::string>& assignments = {}) {
  const auto settings = parse_settings(text, "f.yaml", assignments);
  return settings ? "none" : settings.error().message;
}

TEST(Sources, FaultsNameTheEntryTheKeyAndThePlace) {
  EXPECT_THAT(fault("sources: 5\n"), HasSubstr("f.yaml:1:1: sources: expected a list of sources, found '5'"));
  EXPECT_THAT(fault("sources:\n  - {kind: usb}\n  - {kind: usb, seriall: 3}\n"),
              HasSubstr("f.yaml:3:17: sources[1].seriall: expected a known key (nearest: sources[1].serial)"));
  EXPECT_THAT(fault("sources:\n  - {kind: v4l2}\n"), HasSubstr("sources[0].kind: expected device with kind v4l2"));
  EXPECT_THAT(fault("sources:\n  - {name: a}\n"), HasSubstr("expected what the source is"));
  EXPECT_THAT(fault("sources:\n  - {kind: usb, name: a}\n  - {kind: usb, name: a}\n"),
              HasSubstr("sources[1].name: expected names that differ, found 'a' again"));
  EXPECT_THAT(fault("source: {kind: usb}\nsources:\n  - {kind: usb}\n"),
              HasSubstr("expected either source or the list sources, found both"));
  EXPECT_THAT(fault("sensor: {range_max_m: 3}\nsources:\n  - {kind: usb}\n"),
              HasSubstr("expected `sensor` inside each entry of sources"));
  EXPECT_THAT(fault("sources:\n  - {kind: usb, usb_id: 12}\n"), HasSubstr("sources[0].usb_id: expected VVVV:PPPP"));
  const std::string camera = "sources:\n  - {kind: v4l2, device: /dev/video0";
  const std::string optics = ", sensor: {projection: pinhole, parameters: {fx_px: 9, fy_px: 9, cx_px: 4, cy_px: 4}}}\n";
  EXPECT_THAT(fault(camera + "}\npose: {source: static}\n"),
              HasSubstr("f.yaml:2:6: sources[0].kind: expected a sensor with projection pinhole"));
  EXPECT_THAT(fault(camera + optics), HasSubstr("expected pose.source udp or static with kind v4l2"));
  EXPECT_EQ(fault(camera + optics + "pose: {source: udp}\n"), "none");
  EXPECT_THAT(fault("source: {kind: simulated, terrain: a, sensor: b, trajectory: c}\nsensor: {range_max_m: 3}\n"),
              HasSubstr("expected no `sensor` with kind simulated, which has its own, found sensor.range_max_m"));
  EXPECT_THAT(fault("sources:\n  - {kind: usb}\n  - {kind: recording, path: a}\n"),
              HasSubstr("sources[1].kind: expected live sources beside each other"));
  EXPECT_THAT(fault("", {"sources[9].kind=usb"}), HasSubstr("sources[9].kind: expected a known key"));
  EXPECT_THAT(fault("sources: [{}, {}, {}, {}, {}, {}, {}, {}, {}]\n"),
              HasSubstr("expected at most 8 sources, found 9"));
}

TEST(Sources, UsbIdsAreFourHexadecimalDigitsEach) {
  const auto id = parse_usb_id("1209:00fF");
  ASSERT_TRUE(id);
  EXPECT_EQ(id->vendor, 0x1209);
  EXPECT_EQ(id->product, 0x00FF);
  for (const char* wrong : {"", "1209", "1209:1", "1209-0001", "120g:0001", "1209:00001", "+209:0001"})
    EXPECT_FALSE(parse_usb_id(wrong)) << wrong;
}

}  // namespace
}  // namespace scree::config
