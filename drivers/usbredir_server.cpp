#include "drivers/usbredir_server.hpp"

#include <chrono>
#include <utility>

#include "drivers/usbredir_port.hpp"

namespace scree::drivers {
namespace {

constexpr std::chrono::milliseconds kRetry{250};

}  // namespace

void UsbredirPort::connect() {
  const MonotonicTime now = MonotonicClock::now();
  if (now < next_try) return;
  next_try = now + kRetry;
  auto connected = StreamSocket::connect_to(address, std::chrono::milliseconds(0));
  if (!connected) return;
  socket = *std::move(connected);
  open_parser();
}

void UsbredirPort::disconnect() {
  device.reset([](const usb::TransferAnswer&) {});  // there is nobody left to answer
  parser.reset();
  socket.reset();
  greeted = plugged = lost = false;
}

void UsbredirPort::serve() {
  if (!socket) {
    connect();
    if (!socket) return;
  }
  if (usbredirparser_do_read(parser.get()) == usbredirparser_read_io_error && lost) {
    disconnect();
    return;
  }
  if (greeted && link.unplugged == plugged) {
    if (plugged) {
      device.reset(sink());
      usbredirparser_send_device_disconnect(parser.get());
      plugged = false;
    } else {
      announce();
    }
  }
  if (plugged) device.pump(link, MonotonicClock::now(), sink());
  if (usbredirparser_has_data_to_write(parser.get()) > 0) (void)usbredirparser_do_write(parser.get());
  if (lost) disconnect();
}

Result<std::unique_ptr<FrameServer>> UsbredirServer::open(const std::string& path, const ServedShape& shape) {
  auto address = unix_address(path, "usbredir:", "--serve");
  if (!address) return address.error();
  return std::unique_ptr<FrameServer>(new UsbredirServer(std::make_unique<UsbredirPort>(*std::move(address), shape)));
}

UsbredirServer::UsbredirServer(std::unique_ptr<UsbredirPort> port) : port_(std::move(port)) {}
UsbredirServer::~UsbredirServer() = default;

std::string UsbredirServer::address() const {
  return "usbredir:" + port_->address.host;
}

void UsbredirServer::serve() {
  port_->serve();
}

void UsbredirServer::send(const ServedFrame& frame) {
  port_->device.send(frame);
  port_->serve();
}

std::size_t UsbredirServer::readers() const {
  return port_->device.readers();
}

bool UsbredirServer::busy() const {
  return port_->device.busy();
}

const FrameServerCounters& UsbredirServer::counters() const {
  return port_->device.counters();
}

void UsbredirServer::set_link(const LinkState& link) {
  port_->link = link;
}

void UsbredirServer::stall() {
  port_->device.stall();
}

void UsbredirServer::babble() {
  port_->device.babble();
}

}  // namespace scree::drivers
