// What `scree devices` tells of the devices that were found.

#include "node/devices_report.hpp"

#include <gtest/gtest.h>

#include "drivers/v4l2_formats.hpp"

namespace scree::node {
namespace {

ConnectedDevices two_devices() {
  drivers::V4l2DeviceInfo camera{
      "/dev/video0", "/dev/v4l/by-id/usb-D-index0", {"uvcvideo", "D", "usb-1", true, true, {}}, ""};
  camera.capabilities.formats = {
      {drivers::v4l2::fourcc_of("Z16 "), "Depth", {{480, 640, 480, 640, {30.0, 15.0}, false}}},
      {drivers::v4l2::fourcc_of("YUYV"), "Colour", {{120, 160, 480, 640, {60.0, 1.0}, true}}}};
  return {{camera, {"/dev/video1", "", {}, "'/dev/video1': denied"}}, {}, {}};
}

TEST(DevicesReport, HasALineForWhatCanBeUsedAndTheReasonForWhatCannot) {
  EXPECT_EQ(devices_text(two_devices()),
            "/dev/video0  D (uvcvideo, usb-1)\n"
            "  always the same: /dev/v4l/by-id/usb-D-index0\n"
            "  offers Z16 640 x 480 at 30, 15 Hz\n"
            "  offers YUYV 160 x 120 … 640 x 480 at 60 … 1 Hz  (no range format)\n"
            "  can be used: source.kind v4l2\n"
            "/dev/video1\n"
            "  cannot be used: '/dev/video1': denied\n");
}

TEST(DevicesReport, OfNoDeviceIsOneLine) {
  EXPECT_EQ(devices_text({}), "no devices: no V4L2 node /dev/video*, no range scanner on USB\n");
  EXPECT_EQ(devices_json({}), "{\n  \"v4l2\": [],\n  \"usb\": [],\n  \"usb_error\": \"\"\n}\n");
}

TEST(DevicesReport, UsbScannersAreToldWithTheReasonWhyNot) {
  ConnectedDevices devices;
  devices.usb.push_back({1, 4, "/dev/bus/usb/001/004", "1-2", 0x1209, 1, "Scree scanner", "A1", 0, "480 Mbit/s", ""});
  devices.usb.push_back({1, 5, "/dev/bus/usb/001/005", "1-3", 0x1209, 1, "", "", -1, "unknown", "expected X, found Y"});
  EXPECT_EQ(devices_text(devices),
            "/dev/bus/usb/001/004  Scree scanner (1209:0001, serial 'A1', 480 Mbit/s, port 1-2)\n"
            "  can be used: source.kind usb\n"
            "/dev/bus/usb/001/005  a device without a name (1209:0001, serial '', unknown, port 1-3)\n"
            "  cannot be used: expected X, found Y\n");
  const auto json = devices_json(devices);
  EXPECT_NE(json.find("\"id\": \"1209:0001\""), std::string::npos);
  EXPECT_NE(json.find("\"usable\": false"), std::string::npos);
  EXPECT_EQ(devices_text({{}, {}, "built without USB"}),
            "no devices: no V4L2 node /dev/video*\nUSB could not be looked at: built without USB\n");
}

TEST(DevicesReport, JsonHasTheSame) {
  const std::string json = devices_json(two_devices());
  for (const char* part : {R"("path": "/dev/video0")", R"("by_id": "/dev/v4l/by-id/usb-D-index0")", R"("card": "D")",
                           R"("usable": true)", R"("format": "Z16")", R"("rows": 480)", R"("max_columns": 640)",
                           R"("any_rate": true)", R"("reason": "'/dev/video1': denied")"})
    EXPECT_NE(json.find(part), std::string::npos) << part << " is not in\n" << json;
}

TEST(DevicesReport, ANameThatIsNoTextDoesNotCostTheDocument) {
  auto devices = two_devices();
  devices.v4l2[0].capabilities.card = "\xFF\xFE";
  EXPECT_NE(devices_json(devices).find("/dev/video1"), std::string::npos);
}

}  // namespace
}  // namespace scree::node
