#include "drivers/simulated_usb_descriptors.hpp"

#include <algorithm>
#include <initializer_list>
#include <ratio>

#include "drivers/usb_protocol.hpp"

namespace scree::drivers::usb {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr std::uint8_t low(std::uint32_t value, int byte = 0) {
  return static_cast<std::uint8_t>(value >> (8 * byte));
}

Bytes u16(std::uint32_t value) {
  return {low(value), low(value, 1)};
}

Bytes u32(std::uint32_t value) {
  return {low(value), low(value, 1), low(value, 2), low(value, 3)};
}

Bytes joined(std::initializer_list<Bytes> parts) {
  Bytes all;
  for (const Bytes& part : parts) all.insert(all.end(), part.begin(), part.end());
  return all;
}

/// The length of the whole, in the two bytes at `at`.
Bytes with_total(Bytes bytes, std::size_t at, std::size_t total) {
  bytes[at] = low(static_cast<std::uint32_t>(total));
  bytes[at + 1] = low(static_cast<std::uint32_t>(total), 1);
  return bytes;
}

/// bLength, type 3, UTF-16LE. The names are ASCII.
Bytes string_descriptor(const std::string& text) {
  Bytes bytes{0, 3};
  for (const char c : text.substr(0, 126)) {
    bytes.push_back(static_cast<std::uint8_t>(c));
    bytes.push_back(0);
  }
  bytes[0] = low(static_cast<std::uint32_t>(bytes.size()));
  return bytes;
}

enum StringIndex : std::uint8_t { kNoName, kProductName, kSerialNumber, kScannerName, kCameraName };

// The tables read best a field a line.
// clang-format off

/// Type 4.
Bytes interface(std::uint8_t number, std::uint8_t endpoints, std::uint8_t its_class, std::uint8_t subclass,
                std::uint8_t protocol, std::uint8_t name) {
  return {9, 4, number,
          0,                               // bAlternateSetting
          endpoints, its_class, subclass, protocol, name};
}

/// Type 5.
Bytes bulk_endpoint(std::uint8_t address) {
  return {7, 5, address,
          2,                               // bmAttributes: bulk
          low(kBulkPacketBytes), low(kBulkPacketBytes, 1),
          0};                              // bInterval: none
}

/// The class-specific part (type 0x24) of the control interface: a camera terminal (1) that feeds the USB terminal (2).
Bytes camera_topology() {
  const Bytes input{18, 0x24, 2,           // VC_INPUT_TERMINAL
                    1,                     // bTerminalID
                    0x01, 0x02,            // wTerminalType: ITT_CAMERA
                    0,                     // bAssocTerminal: none
                    kNoName,
                    0, 0, 0, 0, 0, 0,      // wObjectiveFocalLengthMin, Max, wOcularFocalLength: no zoom
                    3, 0, 0, 0};           // bControlSize, bmControls: none
  const Bytes output{9, 0x24, 3,           // VC_OUTPUT_TERMINAL
                     2,                    // bTerminalID
                     0x01, 0x01,           // wTerminalType: TT_STREAMING
                     0,                    // bAssocTerminal: none
                     1,                    // bSourceID
                     kNoName};
  const Bytes header{13, 0x24, 1,          // VC_HEADER
                     0x10, 0x01,           // bcdUVC: 1.1
                     0, 0,                 // wTotalLength
                     0x40, 0x42, 0x0F, 0x00,  // dwClockFrequency: 1 MHz, not used (payloads carry no time)
                     1, kCameraInterface};    // bInCollection, baInterfaceNr
  return joined({with_total(header, 5, header.size() + input.size() + output.size()), input, output});
}

/// The class-specific part of the streaming interface: one format, one size, one interval.
Bytes camera_formats(const ServedShape& shape) {
  const std::uint32_t size = image_bytes(shape), interval = frame_interval(shape);
  const auto bit_rate = static_cast<std::uint32_t>(std::min(8.0 * size * 1e7 / interval, 4294967295.0));
  const Bytes format{27, 0x24, 4,          // VS_FORMAT_UNCOMPRESSED
                     1, 1,                 // bFormatIndex, bNumFrameDescriptors
                     'Z', '1', '6', ' ', 0x00, 0x00, 0x10, 0x00,      // guidFormat: a four-letter code …
                     0x80, 0x00, 0x00, 0xAA, 0x00, 0x38, 0x9B, 0x71,  // … and the tail that all of them have
                     16,                   // bBitsPerPixel
                     1,                    // bDefaultFrameIndex
                     0, 0, 0, 0};          // aspect ratio, interlacing, copy protection: none
  const Bytes frame = joined({{30, 0x24, 5,                  // VS_FRAME_UNCOMPRESSED
                               1, 0},                        // bFrameIndex, bmCapabilities: no still image
                              u16(static_cast<std::uint32_t>(shape.columns)),
                              u16(static_cast<std::uint32_t>(shape.rows)),
                              u32(bit_rate), u32(bit_rate),  // dwMinBitRate, dwMaxBitRate
                              u32(size),                     // dwMaxVideoFrameBufferSize
                              u32(interval), {1}, u32(interval)});  // the default of one discrete interval
  const Bytes header{14, 0x24, 1,          // VS_INPUT_HEADER
                     1,                    // bNumFormats
                     0, 0,                 // wTotalLength
                     kCameraEndpoint,
                     0,                    // bmInfo: the format does not change
                     2,                    // bTerminalLink
                     0, 0, 0,              // still images, trigger: none
                     1, 0};                // bControlSize, bmaControls
  return joined({with_total(header, 4, header.size() + format.size() + frame.size()), format, frame});
}

Bytes camera_function(const ServedShape& shape) {
  const Bytes association{8, 11, kCameraControlInterface,
                          2,               // bInterfaceCount
                          0x0E, 3, 0,      // CC_VIDEO, SC_VIDEO_INTERFACE_COLLECTION
                          kCameraName};
  return joined({association,
                 interface(kCameraControlInterface, 0, 0x0E, 1, 0, kCameraName), camera_topology(),
                 interface(kCameraInterface, 1, 0x0E, 2, 0, kNoName), camera_formats(shape),
                 bulk_endpoint(kCameraEndpoint)});
}

Bytes configuration(const ServedShape& shape) {
  const Bytes head{9, 2,
                   0, 0,                   // wTotalLength
                   static_cast<std::uint8_t>(shape.camera ? 3 : 1),  // bNumInterfaces
                   1,                      // bConfigurationValue
                   kNoName,
                   0x80, 50};              // powered by the bus, 100 mA
  const Bytes scanner = interface(kScannerInterface, 1, kInterfaceClass, kInterfaceSubclass, kInterfaceProtocol,
                                  kScannerName);
  const Bytes whole = joined({head, scanner, bulk_endpoint(kFrameEndpoint),
                              shape.camera ? camera_function(shape) : Bytes{}});
  return with_total(whole, 2, whole.size());
}

/// Type 1. Class 0xEF 2 1: functions of several interfaces, each named by an association.
Bytes device(bool composite) {
  return joined({{18, 1,
                  0x00, 0x02,              // bcdUSB: 2.0
                  static_cast<std::uint8_t>(composite ? 0xEF : 0), static_cast<std::uint8_t>(composite ? 2 : 0),
                  static_cast<std::uint8_t>(composite ? 1 : 0),
                  64},                     // bMaxPacketSize0
                 u16(kVendorId), u16(kProductId),
                 {0x00, 0x01,              // bcdDevice: 1.0
                  kNoName, kProductName, kSerialNumber,
                  1}});                    // bNumConfigurations
}

// clang-format on

}  // namespace

std::uint32_t frame_interval(const ServedShape& shape) {
  using Ticks = std::chrono::duration<std::int64_t, std::ratio<1, 10'000'000>>;
  return static_cast<std::uint32_t>(
      std::clamp<std::int64_t>(std::chrono::round<Ticks>(shape.frame_period).count(), 1, 0xFFFF'FFFF));
}

std::uint32_t image_bytes(const ServedShape& shape) {
  return 2 * static_cast<std::uint32_t>(shape.rows) * static_cast<std::uint32_t>(shape.columns);
}

Descriptors make_descriptors(const ServedShape& shape) {
  Descriptors made;
  made.device = device(shape.camera);
  made.configuration = configuration(shape);
  made.qualifier.assign(made.device.begin(), made.device.begin() + 8);  // the same head, no other configuration
  made.qualifier[0] = 10;
  made.qualifier[1] = static_cast<std::uint8_t>(DescriptorType::device_qualifier);
  made.qualifier.resize(10);
  made.strings = {{4, 3, 0x09, 0x04},  // US English
                  string_descriptor(shape.device),
                  string_descriptor(std::string(kSimulatedSerial)),
                  string_descriptor("frame stream"),
                  string_descriptor("depth image")};
  return made;
}

}  // namespace scree::drivers::usb
