// scree devices: what is connected, and what of it the node can use.

#include <CLI/CLI.hpp>
#include <memory>
#include <utility>

#include "node/commands/command_line.hpp"
#include "node/devices_report.hpp"

namespace scree::node {
namespace {

ConnectedDevices find_devices() {
  ConnectedDevices devices;
  devices.v4l2 = drivers::list_v4l2_devices();
  auto usb = drivers::list_usb_scanners();
  if (usb)
    devices.usb = *std::move(usb);
  else
    devices.usb_error = usb.error().message;
  return devices;
}

}  // namespace

Command add_devices(CLI::App& app) {
  auto json = std::make_shared<bool>(false);
  CLI::App* command = app.add_subcommand("devices", "What is connected, and what of it can be used");
  command->add_flag("--json", *json, "Print one JSON document");
  return {command, [json]() -> Result<int> {
            const ConnectedDevices devices = find_devices();
            if (const auto printed = print(*json ? devices_json(devices) : devices_text(devices)); !printed)
              return printed.error();
            return 0;
          }};
}

}  // namespace scree::node
