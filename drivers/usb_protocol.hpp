#pragma once
// What a Scree range scanner on USB has beyond the frame stream that it speaks (docs/usb-protocol.md): identity,
// interface, endpoint, control requests. The driver (usb_source) and the simulated device share it.

#include <cstdint>

namespace scree::drivers::usb {

/// pid.codes' number for private testing: a product replaces it by its own, and configures `source.usb_id`.
inline constexpr std::uint16_t kVendorId = 0x1209;
inline constexpr std::uint16_t kProductId = 0x0001;

/// The interface of the scanner is found by these three, whatever its number.
inline constexpr std::uint8_t kInterfaceClass = 0xFF;     ///< vendor specific
inline constexpr std::uint8_t kInterfaceSubclass = 0x53;  ///< 'S'
inline constexpr std::uint8_t kInterfaceProtocol = 0x01;  ///< major version of the frame stream

/// The one bulk IN endpoint of the interface is found by its type; the simulated device has it here.
inline constexpr std::uint8_t kFrameEndpoint = 0x81;

/// Vendor requests to the interface (bmRequestType 0xC1 in, 0x41 out; wIndex = number of the interface).
enum class Request : std::uint8_t {
  get_info = 1,  ///< in, 8 bytes: protocol major, minor (u8), 0 (u16), largest message in bytes (u32), little-endian
  set_streaming = 2,  ///< out, no data: wValue 1 = begin with GEOMETRY at the start of a message, 0 = stop
};
inline constexpr std::uint16_t kInfoBytes = 8;

}  // namespace scree::drivers::usb
