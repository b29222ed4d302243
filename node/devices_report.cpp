#include "node/devices_report.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "drivers/v4l2_formats.hpp"

namespace scree::node {
namespace {

using Json = nlohmann::ordered_json;

Json size_json(const drivers::v4l2::FrameSize& size) {
  Json json{{"rows", size.rows}, {"columns", size.columns}};
  if (size.max_rows != size.rows || size.max_columns != size.columns) {
    json["max_rows"] = size.max_rows;
    json["max_columns"] = size.max_columns;
  }
  json["rates_hz"] = size.rates_hz;
  if (size.any_rate) json["any_rate"] = true;
  return json;
}

Json format_json(const drivers::v4l2::FormatOffer& format) {
  Json json{{"format", drivers::v4l2::fourcc_text(format.fourcc)},
            {"description", format.description},
            {"usable", drivers::v4l2::range_format(format.fourcc) != nullptr},
            {"sizes", Json::array()}};
  for (const auto& size : format.sizes) json["sizes"].push_back(size_json(size));
  return json;
}

Json device_json(const drivers::V4l2DeviceInfo& device) {
  const auto& told = device.capabilities;
  Json json{{"path", device.path},     {"by_id", device.stable},  {"card", told.card},
            {"driver", told.driver},   {"bus", told.bus},         {"usable", device.reason.empty()},
            {"reason", device.reason}, {"formats", Json::array()}};
  for (const auto& format : told.formats) json["formats"].push_back(format_json(format));
  return json;
}

std::string device_text(const drivers::V4l2DeviceInfo& device) {
  const auto& told = device.capabilities;
  std::string out = device.path;
  if (!told.card.empty()) out += fmt::format("  {} ({}, {})", told.card, told.driver, told.bus);
  out += '\n';
  if (!device.stable.empty()) out += fmt::format("  always the same: {}\n", device.stable);
  for (const auto& format : told.formats) {
    const char* mark = drivers::v4l2::range_format(format.fourcc) ? "" : "  (no range format)";
    out += fmt::format("  offers {}{}\n", drivers::v4l2::offers_text({format}), mark);
  }
  if (device.reason.empty()) return out + "  can be used: source.kind v4l2\n";
  return out + fmt::format("  cannot be used: {}\n", device.reason);
}

Json device_json(const drivers::UsbDeviceInfo& device) {
  return {{"node", device.node},
          {"ports", device.ports},
          {"id", fmt::format("{:04x}:{:04x}", device.vendor_id, device.product_id)},
          {"product", device.product},
          {"serial", device.serial},
          {"interface", device.interface_number},
          {"speed", device.speed},
          {"usable", device.usable()},
          {"reason", device.why_not}};
}

std::string device_text(const drivers::UsbDeviceInfo& device) {
  std::string out = fmt::format("{}  {} ({:04x}:{:04x}, serial '{}', {}, port {})\n", device.node,
                                device.product.empty() ? "a device without a name" : device.product, device.vendor_id,
                                device.product_id, device.serial, device.speed, device.ports);
  if (device.usable()) return out + "  can be used: source.kind usb\n";
  return out + fmt::format("  cannot be used: {}\n", device.why_not);
}

}  // namespace

std::string devices_text(const ConnectedDevices& devices) {
  std::string out;
  for (const auto& device : devices.v4l2) out += device_text(device);
  for (const auto& device : devices.usb) out += device_text(device);
  if (out.empty() && devices.usb_error.empty())
    out = "no devices: no V4L2 node /dev/video*, no range scanner on USB\n";
  else if (out.empty())
    out = "no devices: no V4L2 node /dev/video*\n";
  if (!devices.usb_error.empty()) out += fmt::format("USB could not be looked at: {}\n", devices.usb_error);
  return out;
}

std::string devices_json(const ConnectedDevices& devices) {
  Json json{{"v4l2", Json::array()}, {"usb", Json::array()}, {"usb_error", devices.usb_error}};
  for (const auto& device : devices.v4l2) json["v4l2"].push_back(device_json(device));
  for (const auto& device : devices.usb) json["usb"].push_back(device_json(device));
  // names come from the device, and may be no UTF-8
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace scree::node
