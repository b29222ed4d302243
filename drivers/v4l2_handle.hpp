#pragma once
// A descriptor of a V4L2 device node: every system call of the driver but mmap goes through here.

#include <chrono>
#include <string>
#include <utility>

#include "core/result.hpp"

namespace scree::drivers::v4l2 {

/// Owns the descriptor. Not blocking.
class Handle {
 public:
  Handle() = default;
  Handle(Handle&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  Handle& operator=(Handle&& other) noexcept {
    std::swap(fd_, other.fd_);
    return *this;
  }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  ~Handle();

  /// Errors: no_input where there is no such device, unavailable otherwise; the message says what may help.
  static Result<Handle> open(const std::string& path);

  /// ioctl(2), again after EINTR. 0 or errno.
  int control(unsigned long request, void* argument) const;

  /// poll(2) for a filled buffer. `failed`: the device is in error, gone, or nothing is queued.
  struct Readiness {
    bool ready = false;
    bool failed = false;
  };
  Readiness wait(std::chrono::milliseconds timeout) const;

  int descriptor() const { return fd_; }

 private:
  explicit Handle(int fd) : fd_(fd) {}
  int fd_ = -1;
};

/// What open(2) of a device node that failed with `error` means to the user.
Error open_error(const std::string& path, int error);

/// The device is not there: unplugged, or not yet plugged in.
bool is_absent(int error);

/// no_input for an absent device, unavailable otherwise: "PATH: CALL: expected success, found REASON".
Error call_error(const std::string& path, const char* call, int error);

}  // namespace scree::drivers::v4l2
