#include "drivers/simulated_usb_camera.hpp"

#include "drivers/little_endian.hpp"
#include "drivers/simulated_usb_descriptors.hpp"

namespace scree::drivers::usb {
namespace {

// UVC 1.1, table A-8; GET_CUR, _MIN, _MAX and _DEF are the same where there is no choice.
constexpr std::uint8_t kSetCur = 0x01, kGetCur = 0x81, kGetMin = 0x82, kGetMax = 0x83, kGetLen = 0x85, kGetInfo = 0x86,
                       kGetDef = 0x87;
constexpr std::uint8_t kErrorCodeControl = 0x02;                        // of the control interface
constexpr std::uint8_t kProbeControl = 0x01, kCommitControl = 0x02;     // of the streaming interface
constexpr std::uint8_t kInvalidControl = 0x06, kInvalidRequest = 0x07;  // error codes
constexpr std::uint8_t kOutToInterface = 0x21, kInFromInterface = 0xA1;
constexpr std::size_t kOldProbeBytes = 26;  // UVC 1.0 hosts know no more

std::vector<std::uint8_t> small(std::initializer_list<std::uint8_t> bytes) {
  return bytes;
}

}  // namespace

CameraControl::CameraControl(const ServedShape& shape) {
  ByteWriter writer(probe_);
  writer.put(std::uint16_t{1});       // bmHint: the interval is fixed
  writer.put(std::uint8_t{1});        // bFormatIndex
  writer.put(std::uint8_t{1});        // bFrameIndex
  writer.put(frame_interval(shape));  // dwFrameInterval
  writer.fill(10);                    // key frames, quality, window, delay: none
  writer.put(image_bytes(shape));     // dwMaxVideoFrameSize
  writer.put(static_cast<std::uint32_t>(image_bytes(shape) + kCameraHeaderBytes));  // dwMaxPayloadTransferSize
  writer.put(std::uint32_t{1'000'000});                                             // dwClockFrequency
  writer.put(std::uint8_t{3});  // bmFramingInfo: FID and EOF are in every header
  writer.put(std::uint8_t{1});  // versions: preferred, least, largest
  writer.put(std::uint8_t{1});
  writer.put(std::uint8_t{1});
}

ControlReply CameraControl::answer(const ControlRequest& request, std::span<const std::uint8_t> data) {
  const auto interface = static_cast<std::uint8_t>(request.index);
  return interface == kCameraControlInterface ? answer_control(request) : answer_streaming(request, data);
}

ControlReply CameraControl::refuse(std::uint8_t error) {
  error_ = error;
  return std::nullopt;
}

ControlReply CameraControl::answer_control(const ControlRequest& request) {
  const bool is_error_code = request.index >> 8 == 0 && request.value >> 8 == kErrorCodeControl;
  if (!is_error_code) return refuse(kInvalidControl);
  if (request.request_type != kInFromInterface || (request.request != kGetCur && request.request != kGetInfo))
    return refuse(kInvalidRequest);
  return small({request.request == kGetInfo ? std::uint8_t{1} : error_});
}

ControlReply CameraControl::answer_streaming(const ControlRequest& request, std::span<const std::uint8_t> data) {
  const int control = request.value >> 8;
  if (control != kProbeControl && control != kCommitControl) return refuse(kInvalidControl);
  if (request.request_type == kOutToInterface) {
    if (request.request != kSetCur || data.size() < kOldProbeBytes) return refuse(kInvalidRequest);
    return small({});  // its format and size are the only ones there are
  }
  switch (request.request) {
    case kGetCur:
    case kGetMin:
    case kGetMax:
    case kGetDef:
      return std::vector<std::uint8_t>(probe_.begin(), probe_.end());
    case kGetLen:
      return small({kProbeBytes, 0});
    case kGetInfo:
      return small({3});  // can be read and set
    default:
      return refuse(kInvalidRequest);
  }
}

}  // namespace scree::drivers::usb
