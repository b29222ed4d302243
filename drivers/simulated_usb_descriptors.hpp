#pragma once
// What the simulated scanner says of itself on USB: the bytes of its descriptors (USB 2.0, 9.6; UVC 1.1, 3).

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/time.hpp"
#include "drivers/frame_server.hpp"

namespace scree::drivers::usb {

inline constexpr std::uint8_t kScannerInterface = 0;
inline constexpr std::uint8_t kCameraControlInterface = 1;
inline constexpr std::uint8_t kCameraInterface = 2;
inline constexpr std::uint8_t kCameraEndpoint = 0x82;
inline constexpr std::uint16_t kBulkPacketBytes = 512;  ///< of every bulk endpoint at high speed
inline constexpr std::string_view kSimulatedSerial = "simulated-1";
inline constexpr std::size_t kCameraHeaderBytes = 2;  ///< of a UVC payload

enum class DescriptorType : std::uint8_t { device = 1, configuration = 2, string = 3, device_qualifier = 6 };

struct Descriptors {
  std::vector<std::uint8_t> device;
  std::vector<std::uint8_t> configuration;         ///< with everything in it
  std::vector<std::uint8_t> qualifier;             ///< what it would be at full speed: nothing
  std::vector<std::vector<std::uint8_t>> strings;  ///< 0 = languages
};

/// A vendor-class interface with one bulk endpoint and, if the device has a camera, a UVC function that offers one
/// uncompressed Z16 format of rows × columns on a bulk endpoint. Pure.
Descriptors make_descriptors(const ServedShape& shape);

/// Of a frame, in UVC's unit of 100 ns.
std::uint32_t frame_interval(const ServedShape& shape);
/// Bytes of an image.
std::uint32_t image_bytes(const ServedShape& shape);

}  // namespace scree::drivers::usb
