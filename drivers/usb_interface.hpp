#pragma once
// What USB devices say of themselves, as far as a range scanner needs it. Adapter of libusb: the types are its own.

#include <cstdint>
#include <optional>
#include <string>

#include "core/result.hpp"
#include "drivers/usb_protocol.hpp"

struct libusb_device;
struct libusb_config_descriptor;

namespace scree::drivers::usb {

/// Where the frames come out.
struct Interface {
  int number = 0;
  int alternate = 0;
  std::uint8_t endpoint = 0;     ///< bulk IN
  std::uint16_t max_packet = 0;  ///< bytes, > 0
};

/// The scanner's interface in a configuration: by class, subclass and protocol, whatever its number; its endpoint by
/// direction and type. Errors: bad_data (no such interface, another major version, no bulk IN endpoint).
Result<Interface> find_interface(const libusb_config_descriptor& config);

/// That of the active configuration of `device`. Errors: those above, unavailable (no active configuration).
Result<Interface> find_interface(libusb_device* device);

struct Address {
  int bus = 0, address = 0;
  std::string ports;         ///< as sysfs and lsusb -t have it: "1-2.3"; "usb1" for a root hub
  std::string node() const;  ///< /dev/bus/usb/BBB/DDD
  friend bool operator==(const Address&, const Address&) = default;
};
Address address_of(libusb_device* device);

/// What the kernel read when the device came (sysfs): "product", "serial", …; empty where there is none. Needs no
/// permission for the device itself.
std::string attribute_of(const Address& address, const char* name);

/// `code` of libusb in words: "LIBUSB_ERROR_BUSY".
std::string error_name(int code);
/// The message for `what` having failed with `code` of libusb: object, expected, found, and what helps where that is
/// known (no permission, in use).
std::string failure(const Address& address, int interface, const char* what, int code);

}  // namespace scree::drivers::usb
