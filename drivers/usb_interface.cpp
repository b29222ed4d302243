#include "drivers/usb_interface.hpp"

#include <array>
#include <fmt/format.h>
#include <fstream>
#include <libusb.h>
#include <memory>
#include <span>

namespace scree::drivers::usb {
namespace {

constexpr unsigned kPacketBits = 0x07FF;  // of wMaxPacketSize; the rest is for periodic endpoints

std::optional<Interface> with_endpoint(const libusb_interface_descriptor& alternate) {
  for (const auto& endpoint : std::span(alternate.endpoint, alternate.bNumEndpoints)) {
    const bool in = (endpoint.bEndpointAddress & LIBUSB_ENDPOINT_DIR_MASK) == LIBUSB_ENDPOINT_IN;
    const bool bulk = (endpoint.bmAttributes & LIBUSB_TRANSFER_TYPE_MASK) == LIBUSB_TRANSFER_TYPE_BULK;
    const auto packet = static_cast<std::uint16_t>(endpoint.wMaxPacketSize & kPacketBits);
    if (in && bulk && packet > 0)
      return Interface{alternate.bInterfaceNumber, alternate.bAlternateSetting, endpoint.bEndpointAddress, packet};
  }
  return std::nullopt;
}

}  // namespace

Result<Interface> find_interface(const libusb_config_descriptor& config) {
  std::string found = "none";
  for (const auto& interface : std::span(config.interface, config.bNumInterfaces))
    for (const auto& alternate :
         std::span(interface.altsetting, static_cast<std::size_t>(std::max(interface.num_altsetting, 0)))) {
      if (alternate.bInterfaceClass != kInterfaceClass || alternate.bInterfaceSubClass != kInterfaceSubclass) continue;
      if (alternate.bInterfaceProtocol != kInterfaceProtocol) {
        found = fmt::format("one of protocol {}", alternate.bInterfaceProtocol);
        continue;
      }
      if (const auto complete = with_endpoint(alternate)) return *complete;
      found = fmt::format("interface {} without a bulk IN endpoint", alternate.bInterfaceNumber);
    }
  return Error{ErrorKind::bad_data,
               fmt::format("interface: expected class {:02x}, subclass {:02x}, protocol {} (the major "
                           "version of the frame stream) with a bulk IN endpoint, found {}",
                           kInterfaceClass, kInterfaceSubclass, kInterfaceProtocol, found)};
}

Result<Interface> find_interface(libusb_device* device) {
  libusb_config_descriptor* config = nullptr;
  const int code = libusb_get_active_config_descriptor(device, &config);
  if (code != 0)
    return Error{ErrorKind::unavailable,
                 fmt::format("configuration: expected an active one, found {}", error_name(code))};
  const std::unique_ptr<libusb_config_descriptor, void (*)(libusb_config_descriptor*)> owned(
      config, libusb_free_config_descriptor);
  return find_interface(*config);
}

std::string Address::node() const {
  return fmt::format("/dev/bus/usb/{:03}/{:03}", bus, address);
}

Address address_of(libusb_device* device) {
  Address out{libusb_get_bus_number(device), libusb_get_device_address(device), {}};
  std::array<std::uint8_t, 7> ports{};  // USB's own limit of hubs in a chain
  const int depth = libusb_get_port_numbers(device, ports.data(), static_cast<int>(ports.size()));
  if (depth <= 0) {
    out.ports = fmt::format("usb{}", out.bus);
    return out;
  }
  out.ports = fmt::format("{}-{}", out.bus, fmt::join(std::span(ports).first(static_cast<std::size_t>(depth)), "."));
  return out;
}

std::string attribute_of(const Address& address, const char* name) {
  std::ifstream file(fmt::format("/sys/bus/usb/devices/{}/{}", address.ports, name));
  std::string line;
  std::getline(file, line);
  return line;
}

std::string error_name(int code) {
  return libusb_error_name(code);
}

std::string failure(const Address& address, int interface, const char* what, int code) {
  if (code == LIBUSB_ERROR_ACCESS)
    return fmt::format(
        "{}: expected permission to read and write, found none; copy launch/99-scree.rules to "
        "/etc/udev/rules.d, run 'udevadm control --reload', plug the scanner in again and be in group plugdev",
        address.node());
  if (code == LIBUSB_ERROR_BUSY)
    return fmt::format("{}: expected interface {} to be free, found it in use by another program or driver",
                       address.node(), interface);
  return fmt::format("{}: {}: expected success, found {}", address.node(), what, error_name(code));
}

}  // namespace scree::drivers::usb
