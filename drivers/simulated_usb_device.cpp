#include "drivers/simulated_usb_device.hpp"

#include <algorithm>
#include <memory>
#include <utility>

#include "drivers/little_endian.hpp"
#include "drivers/usb_protocol.hpp"

namespace scree::drivers::usb {
namespace {

// Bits 5 and 6 of bmRequestType, and the recipients in bits 0 … 4.
constexpr std::uint8_t kTypeMask = 0x60, kStandard = 0x00, kClass = 0x20;
constexpr std::uint8_t kVendorIn = 0xC1, kVendorOut = 0x41, kEndpointIn = 0x82, kEndpointOut = 0x02;
// Standard requests (USB 2.0, table 9-4).
constexpr std::uint8_t kGetStatus = 0, kClearFeature = 1, kSetFeature = 3, kGetDescriptor = 6;
constexpr std::uint16_t kEndpointHalt = 0;
// bmHeaderInfo of a UVC payload.
constexpr std::uint8_t kEndOfFrame = 0x02, kPayloadError = 0x40;

/// A payload holds a whole image.
SharedBytes image_payload(const std::vector<std::uint8_t>& image, std::uint8_t frame_id, bool damaged) {
  auto payload = std::make_shared<std::vector<std::uint8_t>>();
  payload->reserve(kCameraHeaderBytes + image.size());
  payload->push_back(kCameraHeaderBytes);
  payload->push_back(static_cast<std::uint8_t>(frame_id | kEndOfFrame | (damaged ? kPayloadError : 0)));
  payload->insert(payload->end(), image.begin(), image.end());
  return payload;
}

}  // namespace

SimulatedUsbDevice::SimulatedUsbDevice(const ServedShape& shape)
    : shape_(shape),
      descriptors_(make_descriptors(shape)),
      camera_(shape),
      frames_(kFrameEndpoint),
      images_(kCameraEndpoint) {}

ControlReply SimulatedUsbDevice::control(const ControlRequest& request, std::span<const std::uint8_t> data) {
  const std::uint8_t type = request.request_type & kTypeMask;
  ControlReply reply;
  if (type == kStandard)
    reply = standard(request);
  else if (type == kClass && shape_.camera)
    reply = camera_.answer(request, data);
  else
    reply = vendor(request);
  if (reply && reply->size() > request.length) reply->resize(request.length);
  return reply;
}

ControlReply SimulatedUsbDevice::standard(const ControlRequest& request) {
  if (request.request_type == kEndpointIn || request.request_type == kEndpointOut) return endpoint_request(request);
  if (request.request == kGetDescriptor) return descriptor(request);
  if (request.request == kGetStatus) return std::vector<std::uint8_t>{0, 0};  // from the bus, no remote wake-up
  return std::nullopt;
}

ControlReply SimulatedUsbDevice::descriptor(const ControlRequest& request) const {
  const auto index = static_cast<std::uint8_t>(request.value);
  switch (static_cast<DescriptorType>(request.value >> 8)) {
    case DescriptorType::device:
      return descriptors_.device;
    case DescriptorType::configuration:
      if (index == 0) return descriptors_.configuration;
      break;
    case DescriptorType::string:
      if (index < descriptors_.strings.size()) return descriptors_.strings[index];
      break;
    case DescriptorType::device_qualifier:
      return descriptors_.qualifier;
  }
  return std::nullopt;
}

ControlReply SimulatedUsbDevice::endpoint_request(const ControlRequest& request) {
  BulkPipe* asked = pipe(static_cast<std::uint8_t>(request.index));
  if (asked == nullptr) return std::nullopt;
  if (request.request == kGetStatus)
    return std::vector<std::uint8_t>{asked->halted() ? std::uint8_t{1} : std::uint8_t{0}, 0};
  if (request.value != kEndpointHalt) return std::nullopt;
  if (request.request == kSetFeature) {
    asked->halt();
  } else if (request.request == kClearFeature) {
    const bool was_halted = asked->halted();
    asked->clear_halt();
    counters_.broken += asked->drop_message() ? 1 : 0;       // what comes next is the start of a message
    if (asked == &images_ && !was_halted) filming_ = false;  // this is how hosts end bulk video
  } else {
    return std::nullopt;
  }
  return std::vector<std::uint8_t>{};
}

ControlReply SimulatedUsbDevice::vendor(const ControlRequest& request) {
  if (static_cast<std::uint8_t>(request.index) != kScannerInterface) return std::nullopt;
  const auto asked = static_cast<Request>(request.request);
  if (request.request_type == kVendorIn && asked == Request::get_info) {
    std::vector<std::uint8_t> info(kInfoBytes);
    ByteWriter writer(info);
    writer.put(kInterfaceProtocol);  // major version of the frame stream
    writer.put(std::uint8_t{0});
    writer.put(std::uint16_t{0});
    writer.put(static_cast<std::uint32_t>(shape_.message_bytes));
    return info;
  }
  if (request.request_type == kVendorOut && asked == Request::set_streaming && request.value <= 1) {
    set_streaming(request.value == 1);
    return std::vector<std::uint8_t>{};
  }
  return std::nullopt;
}

void SimulatedUsbDevice::set_streaming(bool on) {
  counters_.broken += frames_.drop_message() ? 1 : 0;
  counters_.readers += on ? 1 : 0;
  streaming_ = on;
}

bool SimulatedUsbDevice::set_configuration(std::uint8_t number, const AnswerSink& sink) {
  if (number > 1) return false;
  reset(sink);
  configuration_ = number;
  return true;
}

bool SimulatedUsbDevice::set_alternate(std::uint8_t interface, std::uint8_t setting, const AnswerSink& sink) {
  if (!has_interface(interface) || setting != 0) return false;
  if (interface == kScannerInterface) {
    counters_.broken += frames_.reset(sink) ? 1 : 0;
    streaming_ = false;
  } else if (interface == kCameraInterface) {
    counters_.broken += images_.reset(sink) ? 1 : 0;
    filming_ = false;
  }
  return true;
}

void SimulatedUsbDevice::reset(const AnswerSink& sink) {
  for (const std::uint8_t interface : {kScannerInterface, kCameraInterface}) set_alternate(interface, 0, sink);
  configuration_ = 0;
}

BulkPipe* SimulatedUsbDevice::pipe(std::uint8_t endpoint) {
  if (endpoint == kFrameEndpoint) return &frames_;
  return endpoint == kCameraEndpoint && shape_.camera ? &images_ : nullptr;
}

void SimulatedUsbDevice::ask(std::uint8_t endpoint, std::uint64_t id, std::size_t bytes, const AnswerSink& sink) {
  BulkPipe* asked = pipe(endpoint);
  if (asked == nullptr) {
    sink({endpoint, id, TransferStatus::invalid, {}});
    return;
  }
  if (asked == &images_ && !filming_) {
    filming_ = true;
    ++counters_.readers;
  }
  asked->ask(id, bytes);
}

void SimulatedUsbDevice::cancel(std::uint64_t id, const AnswerSink& sink) {
  frames_.cancel(id, sink);
  images_.cancel(id, sink);
}

void SimulatedUsbDevice::pump(const LinkState& link, MonotonicTime now, const AnswerSink& sink) {
  counters_.sent += static_cast<std::uint64_t>(frames_.pump(link, now, sink) + images_.pump(link, now, sink));
}

void SimulatedUsbDevice::send(const ServedFrame& frame) {
  if (readers() == 0) ++counters_.unread;
  if (streaming_) count_offer(frames_.offer(frame.message));
  if (!filming_ || frame.image == nullptr) return;
  if (!images_.has_message()) frame_id_ ^= 1;  // an image that takes another's place takes its number too
  count_offer(images_.offer(image_payload(*frame.image, frame_id_, frame.image_damaged)));
}

}  // namespace scree::drivers::usb
