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

void append(Bytes& to, const Bytes& bytes) {
  to.insert(to.end(), bytes.begin(), bytes.end());
}

Bytes joined(std::initializer_list<Bytes> parts) {
  Bytes all;
  for (const Bytes& part : parts) append(all, part);
  return all;
}

/// bLength, type 3, UTF-16LE. The names are ASCII.
Bytes string_descriptor(const std::string& text) {
  Bytes bytes{0, 3};
  for (const char c : text.substr(0, 126)) append(bytes, {static_cast<std::uint8_t>(c), 0});
  bytes[0] = low(static_cast<std::uint32_t>(bytes.size()));
  return bytes;
}

/// Type 4: number, setting 0, endpoints, class, subclass, protocol, string.
Bytes interface(std::uint8_t number, std::uint8_t endpoints, std::uint8_t its_class, std::uint8_t subclass,
                std::uint8_t protocol, std::uint8_t name) {
  return {9, 4, number, 0, endpoints, its_class, subclass, protocol, name};
}

/// Type 5: address, bulk (2), wMaxPacketSize, no interval.
Bytes bulk_endpoint(std::uint8_t address) {
  return {7, 5, address, 2, low(kBulkPacketBytes), low(kBulkPacketBytes, 1), 0};
}

/// The class-specific part (type 0x24) of the control interface: a camera terminal (1) that feeds the USB terminal (2).
Bytes camera_topology() {
  const Bytes input{18,   0x24, 2, 1,             // VC_INPUT_TERMINAL, id 1
                    0x01, 0x02, 0, 0,             // ITT_CAMERA, associated with none, no name
                    0,    0,    0, 0, 0, 0,       // no optical zoom
                    3,    0,    0, 0};            // bmControls: none
  const Bytes output{9,    0x24, 3, 2,            // VC_OUTPUT_TERMINAL, id 2
                     0x01, 0x01, 0, 1, 0};        // TT_STREAMING, associated with none, source 1, no name
  constexpr std::uint32_t kClock_hz = 1'000'000;  // not used: payloads carry no time
  Bytes header{13,
               0x24,
               1,
               0x10,
               0x01,  // VC_HEADER, UVC 1.1
               0,
               0,  // wTotalLength, below
               low(kClock_hz),
               low(kClock_hz, 1),
               low(kClock_hz, 2),
               low(kClock_hz, 3),  // dwClockFrequency
               1,
               kCameraInterface};  // one streaming interface
  const auto total = static_cast<std::uint32_t>(header.size() + input.size() + output.size());
  header[5] = low(total);
  header[6] = low(total, 1);
  return joined({header, input, output});
}

/// "Z16 " and the tail that every four-letter code has as a GUID.
const Bytes kZ16Guid{'Z', '1', '6', ' ', 0x00, 0x00, 0x10, 0x00, 0x80, 0x00, 0x00, 0xAA, 0x00, 0x38, 0x9B, 0x71};

/// The class-specific part of the streaming interface: one format, one size.
Bytes camera_formats(const ServedShape& shape) {
  const auto rows = static_cast<std::uint32_t>(shape.rows), columns = static_cast<std::uint32_t>(shape.columns);
  const std::uint32_t size = image_bytes(shape), interval = frame_interval(shape);
  const std::uint32_t bit_rate = static_cast<std::uint32_t>(std::min(8.0 * size * 1e7 / interval, 4294967295.0));
  const auto u32 = [](std::uint32_t v) { return Bytes{low(v), low(v, 1), low(v, 2), low(v, 3)}; };
  const Bytes format = joined({{27, 0x24, 4, 1, 1},  // VS_FORMAT_UNCOMPRESSED, index 1, one frame size
                               kZ16Guid,
                               {16, 1, 0, 0, 0, 0}});  // bits a pixel, default size, aspect, interlace, copy
  const Bytes frame = joined({{30, 0x24, 5, 1, 0},     // VS_FRAME_UNCOMPRESSED, index 1, no still image
                              {low(columns), low(columns, 1), low(rows, 0), low(rows, 1)},
                              u32(bit_rate),
                              u32(bit_rate),
                              u32(size),
                              u32(interval),
                              {1},
                              u32(interval)});  // one discrete interval
  const auto total = static_cast<std::uint32_t>(14 + format.size() + frame.size());
  const Bytes header{14,
                     0x24,
                     1,
                     1,
                     low(total),
                     low(total, 1),  // VS_INPUT_HEADER, one format, wTotalLength
                     kCameraEndpoint,
                     0,
                     2,
                     0,
                     0,
                     0,
                     1,
                     0};  // endpoint, fixed format, terminal 2, no stills, triggers
  return joined({header, format, frame});
}

Bytes camera_function(const ServedShape& shape) {
  return joined(
      {{8, 11, kCameraControlInterface, 2, 0x0E, 3, 0, 3},  // IAD: two interfaces, CC_VIDEO, collection, name 3
       interface(kCameraControlInterface, 0, 0x0E, 1, 0, 3),
       camera_topology(),
       interface(kCameraInterface, 1, 0x0E, 2, 0, 0),
       camera_formats(shape),
       bulk_endpoint(kCameraEndpoint)});
}

Bytes configuration(const ServedShape& shape) {
  Bytes bytes{9,
              2,
              0,
              0,  // wTotalLength, below
              static_cast<std::uint8_t>(shape.camera ? 3 : 1),
              1,
              0,  // interfaces, number, no name
              0x80,
              50};  // from the bus, 100 mA
  append(bytes, interface(kScannerInterface, 1, kInterfaceClass, kInterfaceSubclass, kInterfaceProtocol, 2));
  append(bytes, bulk_endpoint(kFrameEndpoint));
  if (shape.camera) append(bytes, camera_function(shape));
  bytes[2] = low(static_cast<std::uint32_t>(bytes.size()));
  bytes[3] = low(static_cast<std::uint32_t>(bytes.size()), 1);
  return bytes;
}

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
  const std::uint8_t device_class = shape.camera ? 0xEF : 0;  // 0xEF 2 1: functions of several interfaces (IAD)
  const std::uint8_t subclass = shape.camera ? 2 : 0, protocol = shape.camera ? 1 : 0;
  Descriptors made;
  made.device = {18,
                 1,
                 0x00,
                 0x02,  // USB 2.0
                 device_class,
                 subclass,
                 protocol,
                 64,  // packet of endpoint 0
                 low(kVendorId),
                 low(kVendorId, 1),
                 low(kProductId),
                 low(kProductId, 1),
                 0x00,
                 0x01,
                 0,
                 1,
                 0,
                 1};  // release 1.0, manufacturer none, product 1, no serial, one configuration
  made.qualifier = {10, 6, 0x00, 0x02, device_class, subclass, protocol, 64, 0, 0};  // no other configuration
  made.configuration = configuration(shape);
  made.strings = {{4, 3, 0x09, 0x04},  // US English
                  string_descriptor(shape.device),
                  string_descriptor("frame stream"),
                  string_descriptor("depth image")};
  return made;
}

}  // namespace scree::drivers::usb
