#pragma once
// A scanner that is open: its interface claimed, its stream switched on, its transfers in flight.

#include <chrono>
#include <memory>

#include "core/result.hpp"
#include "drivers/usb_context.hpp"
#include "drivers/usb_transfers.hpp"

namespace scree::drivers::usb {

/// What the device answers to GET_INFO.
struct Info {
  int major = 0, minor = 0;
  std::uint32_t largest_message = 0;  ///< bytes
};
/// `answer` as it came. Errors: bad_data (another length, another major version).
Result<Info> judge_info(std::span<const std::uint8_t> answer);

/// A control request waits this long, a cancelled transfer is waited for this long: a call takes a few of them at most.
inline constexpr std::chrono::milliseconds kControlTimeout{500};
inline constexpr std::chrono::milliseconds kDrainTimeout{500};

/// Errors are all "unavailable" or "bad_data" and mean that the device is of no use now: close and try again.
class Link {
 public:
  /// Opens, detaches a kernel driver, claims, checks GET_INFO, submits the transfers, SET_STREAMING 1. `context`
  /// outlives the link and watches its device.
  static Result<std::unique_ptr<Link>> open(Context& context, const DeviceRef& device);
  /// SET_STREAMING 0 if the device is there, cancels, drains within kDrainTimeout, releases, closes. A transfer that
  /// does not come back is abandoned (Transfers): closing makes the kernel let go of it, but its memory is not used
  /// again.
  ~Link();
  Link(const Link&) = delete;
  Link& operator=(const Link&) = delete;

  Transfers& transfers() { return *transfers_; }
  /// After a stall or another error of a transfer, once all are back: clear_halt, all submitted anew.
  Status resume();
  /// A silent device: SET_STREAMING 0, all transfers back within kDrainTimeout and forgotten, resume(),
  /// SET_STREAMING 1.
  Status restart_stream();
  /// Resets the device's port. It may come back as another device: close the link after it.
  void reset();
  /// The device has gone: nothing is asked of it any more.
  void set_gone() { gone_ = true; }
  bool gone() const { return gone_; }

 private:
  Link(Context& context, DeviceRef device) : context_(context), device_(std::move(device)) {}
  Status claim();
  Status check_info();
  Status set_streaming(bool on);
  bool drain();
  Status clear_halt();
  Status submit();
  Error failed(const char* what, int code);

  Context& context_;
  DeviceRef device_;
  Interface interface_;
  libusb_device_handle* handle_ = nullptr;
  std::unique_ptr<Transfers> transfers_;
  bool claimed_ = false;
  bool gone_ = false;
};

}  // namespace scree::drivers::usb
