#pragma once
// The simulated scanner at an emulated USB port: QEMU's usb-redir, which listens on a unix socket. usbredir_server.cpp
// is the one place that knows libusbredirparser.

#include <memory>
#include <string>

#include "core/result.hpp"
#include "drivers/frame_server.hpp"

namespace scree::drivers {

struct UsbredirPort;

/// Connects, and again whenever the other end has closed, four times a second. Unplugged, the device is gone while the
/// connection stays. Errors of open(): usage (the path).
class UsbredirServer final : public FrameServer {
 public:
  static Result<std::unique_ptr<FrameServer>> open(const std::string& path, const ServedShape& shape);
  ~UsbredirServer() override;

  std::string address() const override;
  void serve() override;
  void send(const ServedFrame& frame) override;
  std::size_t readers() const override;
  bool busy() const override;
  const FrameServerCounters& counters() const override;
  void set_link(const LinkState& link) override;
  bool has_endpoints() const override { return true; }
  void stall() override;
  void babble() override;

 private:
  explicit UsbredirServer(std::unique_ptr<UsbredirPort> port);
  std::unique_ptr<UsbredirPort> port_;
};

}  // namespace scree::drivers
