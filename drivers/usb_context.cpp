#include "drivers/usb_context.hpp"

#include <algorithm>
#include <chrono>
#include <fmt/format.h>
#include <libusb.h>
#include <signal.h>
#include <thread>
#include <utility>

namespace scree::drivers::usb {
namespace {

constexpr std::chrono::milliseconds kAfterError{50};

/// libusb's threads inherit the mask of who starts them: a signal for the process must not end in one of theirs.
class SignalsBlocked {
 public:
  SignalsBlocked() {
    sigset_t all;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before_);
  }
  ~SignalsBlocked() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }
  SignalsBlocked(const SignalsBlocked&) = delete;
  SignalsBlocked& operator=(const SignalsBlocked&) = delete;

 private:
  sigset_t before_{};
};

}  // namespace

struct Context::Callbacks {
  /// Only notes what happened: libusb forbids most calls in here.
  static int LIBUSB_CALL hotplug(libusb_context*, libusb_device* device, libusb_hotplug_event event, void* user) {
    auto& self = *static_cast<Context*>(user);
    if (event == LIBUSB_HOTPLUG_EVENT_DEVICE_ARRIVED) self.arrived_ = true;
    if (event == LIBUSB_HOTPLUG_EVENT_DEVICE_LEFT && device == self.watched_) self.left_ = true;
    return 0;
  }
};

std::string to_string(const Identity& identity) {
  const auto numbers = fmt::format("{:04x}:{:04x}", identity.vendor_id, identity.product_id);
  return identity.serial.empty() ? numbers : fmt::format("{} serial {}", numbers, identity.serial);
}

Result<std::unique_ptr<Context>> Context::make(const Identity& wanted) {
  std::unique_ptr<Context> out(new Context(wanted));
  if (auto status = out->begin(); !status) return status.error();
  return out;
}

Context::~Context() {
  end();
}

Status Context::begin() {
  const SignalsBlocked while_it_starts;
  const int code = libusb_init(&context_);
  if (code != 0) {
    context_ = nullptr;
    return Error{ErrorKind::unavailable, fmt::format("usb: expected libusb to start, found {}", error_name(code))};
  }
  libusb_set_option(context_, LIBUSB_OPTION_LOG_LEVEL,
                    LIBUSB_LOG_LEVEL_NONE);  // stderr is the log's; we tell of errors
  if (libusb_has_capability(LIBUSB_CAP_HAS_HOTPLUG) == 0) return {};
  // where it cannot be registered scan_again() finds what comes
  libusb_hotplug_register_callback(context_, LIBUSB_HOTPLUG_EVENT_DEVICE_ARRIVED | LIBUSB_HOTPLUG_EVENT_DEVICE_LEFT, 0,
                                   wanted_.vendor_id, wanted_.product_id, LIBUSB_HOTPLUG_MATCH_ANY, Callbacks::hotplug,
                                   this, nullptr);
  return {};
}

void Context::end() {
  if (context_ != nullptr) libusb_exit(std::exchange(context_, nullptr));
}

void Context::handle_events(std::chrono::milliseconds timeout) {
  const auto ms = std::max<std::chrono::milliseconds::rep>(timeout.count(), 0);
  timeval wait{static_cast<time_t>(ms / 1000), static_cast<suseconds_t>(ms % 1000 * 1000)};
  const int code = libusb_handle_events_timeout_completed(context_, &wait, nullptr);
  // an error that stays must not become a loop at full speed
  if (code != 0 && code != LIBUSB_ERROR_INTERRUPTED) std::this_thread::sleep_for(std::min(timeout, kAfterError));
}

std::vector<DeviceRef> Context::devices() const {
  libusb_device** list = nullptr;
  const ssize_t count = libusb_get_device_list(context_, &list);
  std::vector<DeviceRef> out;
  for (ssize_t i = 0; i < count; ++i) out.emplace_back(list[i], libusb_unref_device);
  if (count >= 0) libusb_free_device_list(list, 0);  // the references are ours now
  return out;
}

DeviceRef Context::find() const {
  for (const DeviceRef& device : devices()) {
    libusb_device_descriptor descriptor{};
    if (libusb_get_device_descriptor(device.get(), &descriptor) != 0) continue;
    if (descriptor.idVendor != wanted_.vendor_id || descriptor.idProduct != wanted_.product_id) continue;
    if (wanted_.serial.empty() || attribute_of(address_of(device.get()), "serial") == wanted_.serial) return device;
  }
  return nullptr;
}

Status Context::scan_again() {
  libusb_context* const before = std::exchange(context_, nullptr);
  auto status = begin();
  if (!status)
    context_ = before;
  else if (before != nullptr)
    libusb_exit(before);  // after the new one began: libusb's own thread goes on meanwhile
  return status;
}

bool Context::arrived() {
  return std::exchange(arrived_, false);
}

void Context::watch(const libusb_device* device) {
  watched_ = device;
  left_ = false;
}

}  // namespace scree::drivers::usb
