#pragma once
// libusb's context: which devices are there, who comes and goes, and the one place where its events are handled.

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/result.hpp"
#include "drivers/usb_interface.hpp"

struct libusb_context;
struct libusb_device;

namespace scree::drivers::usb {

/// Which device is meant.
struct Identity {
  std::uint16_t vendor_id = kVendorId, product_id = kProductId;
  std::string serial;  ///< "" = any
};
/// "1209:0001" or "1209:0001 serial ABC".
std::string to_string(const Identity& identity);

/// A counted reference to a device of libusb's list.
using DeviceRef = std::shared_ptr<libusb_device>;

/// Not movable: libusb's callback holds its address. One thread.
class Context {
 public:
  /// Errors: unavailable (libusb does not start).
  static Result<std::unique_ptr<Context>> make(const Identity& wanted);
  ~Context();
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;

  /// Waits at most `timeout` for something to happen on the bus and lets libusb call its callbacks, which only note it.
  void handle_events(std::chrono::milliseconds timeout);

  /// All devices that libusb knows.
  std::vector<DeviceRef> devices() const;
  /// The first that is meant; null = none.
  DeviceRef find() const;
  /// Reads the bus anew. libusb learns of arrivals from udev; where no udev runs (containers, small images) it never
  /// does, and only a context that begins anew sees them. No device of this context may be open.
  Status scan_again();

  /// Whether a device of the wanted numbers has come since the last call.
  bool arrived();
  /// `device` is the one that is in use: left() tells whether it has gone since.
  void watch(const libusb_device* device);
  bool left() const { return left_; }

  libusb_context* get() const { return context_; }

 private:
  explicit Context(Identity wanted) : wanted_(std::move(wanted)) {}
  Status begin();
  void end();
  struct Callbacks;  ///< libusb's types stay in the .cpp

  Identity wanted_;
  libusb_context* context_ = nullptr;
  const libusb_device* watched_ = nullptr;
  bool arrived_ = false;
  bool left_ = false;
};

}  // namespace scree::drivers::usb
