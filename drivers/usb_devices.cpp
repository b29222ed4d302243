#include "drivers/usb_devices.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <libusb.h>
#include <tuple>

#include "drivers/usb_context.hpp"

namespace scree::drivers {
namespace {

std::string speed_of(libusb_device* device) {
  switch (libusb_get_device_speed(device)) {
    case LIBUSB_SPEED_LOW:
      return "1.5 Mbit/s";
    case LIBUSB_SPEED_FULL:
      return "12 Mbit/s";
    case LIBUSB_SPEED_HIGH:
      return "480 Mbit/s";
    case LIBUSB_SPEED_SUPER:
      return "5000 Mbit/s";
    case LIBUSB_SPEED_SUPER_PLUS:
      return "10000 Mbit/s";
    default:
      return "unknown";
  }
}

/// Whether the interface could be used now: "" or why not.
std::string try_out(libusb_device* device, int interface) {
  libusb_device_handle* handle = nullptr;
  const usb::Address address = usb::address_of(device);
  if (const int code = libusb_open(device, &handle); code != 0) return usb::failure(address, interface, "open", code);
  const int code = libusb_claim_interface(handle, interface);
  if (code == 0) libusb_release_interface(handle, interface);
  libusb_close(handle);
  return code == 0 ? "" : usb::failure(address, interface, "claim", code);
}

UsbDeviceInfo describe(libusb_device* device, const libusb_device_descriptor& descriptor) {
  const usb::Address address = usb::address_of(device);
  UsbDeviceInfo out;
  out.bus = address.bus;
  out.address = address.address;
  out.node = address.node();
  out.ports = address.ports;
  out.vendor_id = descriptor.idVendor;
  out.product_id = descriptor.idProduct;
  out.product = usb::attribute_of(address, "product");
  out.serial = usb::attribute_of(address, "serial");
  out.speed = speed_of(device);
  return out;
}

}  // namespace

Result<std::vector<UsbDeviceInfo>> list_usb_scanners() {
  const auto context = usb::Context::make({});
  if (!context) return context.error();
  std::vector<UsbDeviceInfo> out;
  for (const usb::DeviceRef& device : (*context)->devices()) {
    libusb_device_descriptor descriptor{};
    if (libusb_get_device_descriptor(device.get(), &descriptor) != 0) continue;
    const bool ours = descriptor.idVendor == usb::kVendorId && descriptor.idProduct == usb::kProductId;
    const auto interface = usb::find_interface(device.get());
    if (!ours && !interface) continue;
    UsbDeviceInfo& info = out.emplace_back(describe(device.get(), descriptor));
    if (interface) {
      info.interface_number = interface->number;
      info.why_not = try_out(device.get(), interface->number);
    } else {
      info.why_not = interface.error().message;
    }
  }
  std::sort(out.begin(), out.end(), [](const UsbDeviceInfo& a, const UsbDeviceInfo& b) {
    return std::tie(a.bus, a.address) < std::tie(b.bus, b.address);
  });
  return out;
}

}  // namespace scree::drivers
