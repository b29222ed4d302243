#pragma once
// Inside usbredir_server: the device, the connection and the library's parser between them.

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <usbredirparser.h>

#include "core/time.hpp"
#include "drivers/frame_server.hpp"
#include "drivers/simulated_usb_device.hpp"
#include "drivers/stream_socket.hpp"

namespace scree::drivers {

struct DestroyParser {
  void operator()(usbredirparser* parser) const { usbredirparser_destroy(parser); }
};

/// The parser calls back with a pointer to this; it lives at one place.
struct UsbredirPort {
  UsbredirPort(StreamAddress its_address, const ServedShape& shape) : address(std::move(its_address)), device(shape) {}
  UsbredirPort(const UsbredirPort&) = delete;
  UsbredirPort& operator=(const UsbredirPort&) = delete;

  void connect();
  void disconnect();
  /// One round: plugs and unplugs, hears, answers, writes.
  void serve();

  void open_parser();
  void announce();
  void answer(const usb::TransferAnswer& answer);
  void answer_control(std::uint64_t id, usb_redir_control_packet_header header, std::span<const std::uint8_t> data);
  usb::AnswerSink sink() {
    return [this](const usb::TransferAnswer& transfer) { answer(transfer); };
  }

  StreamAddress address;
  usb::SimulatedUsbDevice device;
  LinkState link;
  std::optional<StreamSocket> socket;
  std::unique_ptr<usbredirparser, DestroyParser> parser;
  bool greeted = false;  ///< the other end has said what it can do
  bool plugged = false;  ///< the other end knows the device
  bool lost = false;     ///< the connection
  MonotonicTime next_try{};
};

}  // namespace scree::drivers
