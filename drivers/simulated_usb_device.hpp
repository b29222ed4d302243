#pragma once
// The simulated scanner as a USB device, without the wire: control requests and transfers in, answers out. What carries
// them (usbredir_server) knows nothing of scanners, and this knows nothing of sockets.

#include <cstdint>
#include <span>
#include <vector>

#include "drivers/frame_server.hpp"
#include "drivers/simulated_usb_camera.hpp"
#include "drivers/simulated_usb_descriptors.hpp"
#include "drivers/simulated_usb_pipe.hpp"

namespace scree::drivers::usb {

/// A composite device: the frame stream on a vendor-class interface (usb_protocol.hpp) and, if its shape has a camera,
/// the counts of the same frame as a UVC image. Each of the two is a reader of its own.
class SimulatedUsbDevice {
 public:
  explicit SimulatedUsbDevice(const ServedShape& shape);

  const Descriptors& descriptors() const { return descriptors_; }
  bool has_camera() const { return shape_.camera; }

  /// Anything but SET_ADDRESS, SET_CONFIGURATION and SET_INTERFACE.
  ControlReply control(const ControlRequest& request, std::span<const std::uint8_t> data);
  /// 0 = back to no configuration. False: there is no such configuration.
  bool set_configuration(std::uint8_t number, const AnswerSink& sink);
  std::uint8_t configuration() const { return configuration_; }
  /// There is one alternate setting of each interface. False: no such interface or setting.
  bool set_alternate(std::uint8_t interface, std::uint8_t setting, const AnswerSink& sink);
  bool has_interface(std::uint8_t interface) const { return interface < (shape_.camera ? 3 : 1); }
  /// As after power-on.
  void reset(const AnswerSink& sink);

  void ask(std::uint8_t endpoint, std::uint64_t id, std::size_t bytes, const AnswerSink& sink);
  void cancel(std::uint64_t id, const AnswerSink& sink);
  /// Answers the transfers that can be answered now.
  void pump(const LinkState& link, MonotonicTime now, const AnswerSink& sink);

  void send(const ServedFrame& frame);
  void stall() { frames_.halt(); }
  void babble() { frames_.babble_next(); }

  std::size_t readers() const { return (streaming_ ? 1u : 0u) + (filming_ ? 1u : 0u); }
  bool busy() const { return frames_.has_message() || images_.has_message(); }
  const FrameServerCounters& counters() const { return counters_; }

 private:
  ControlReply standard(const ControlRequest& request);
  ControlReply descriptor(const ControlRequest& request) const;
  ControlReply endpoint_request(const ControlRequest& request);
  ControlReply vendor(const ControlRequest& request);
  BulkPipe* pipe(std::uint8_t endpoint);
  void set_streaming(bool on);
  void stop_filming();
  void count_offer(bool taken) { counters_.superseded += taken ? 0 : 1; }

  ServedShape shape_;
  Descriptors descriptors_;
  CameraControl camera_;
  std::uint8_t configuration_ = 0;
  BulkPipe frames_, images_;
  bool streaming_ = false;     ///< the host has sent SET_STREAMING 1
  bool filming_ = false;       ///< the host has asked for image data, and not cleared the halt of the endpoint since
  std::uint8_t frame_id_ = 0;  ///< toggles from image to image
  FrameServerCounters counters_;
};

}  // namespace scree::drivers::usb
