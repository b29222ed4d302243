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
  return {{camera, {"/dev/video1", "", {}, "'/dev/video1': denied"}}};
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
  EXPECT_EQ(devices_text({}), "no devices: no V4L2 node /dev/video*\n");
  EXPECT_EQ(devices_json({}), "{\n  \"v4l2\": [],\n  \"usb\": []\n}\n");
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
