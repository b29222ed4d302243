#include "drivers/v4l2_handle.hpp"

#include <cerrno>
#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <system_error>
#include <unistd.h>

namespace scree::drivers::v4l2 {

Handle::~Handle() {
  if (fd_ >= 0) ::close(fd_);
}

Result<Handle> Handle::open(const std::string& path) {
  const int fd = ::open(path.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
  if (fd < 0) return open_error(path, errno);
  return Handle(fd);
}

int Handle::control(unsigned long request, void* argument) const {
  while (::ioctl(fd_, request, argument) != 0)
    if (errno != EINTR) return errno;
  return 0;
}

Handle::Readiness Handle::wait(std::chrono::milliseconds timeout) const {
  pollfd watched{fd_, POLLIN, 0};
  const int changed = ::poll(&watched, 1, static_cast<int>(timeout.count()));
  if (changed < 0) return {false, errno != EINTR};
  return {(watched.revents & POLLIN) != 0, (watched.revents & (POLLERR | POLLHUP | POLLNVAL)) != 0};
}

bool is_absent(int error) {
  return error == ENOENT || error == ENODEV || error == ENXIO;
}

Error open_error(const std::string& path, int error) {
  std::string hint;
  if (error == EACCES || error == EPERM)
    hint = " (add the user to the group 'video', or install launch/99-scree.rules as a udev rule)";
  if (error == EBUSY) hint = " (another program uses the device)";
  return {is_absent(error) ? ErrorKind::no_input : ErrorKind::unavailable,
          fmt::format("'{}': expected a device that can be opened, found: {}{}", path,
                      std::generic_category().message(error), hint)};
}

Error call_error(const std::string& path, const char* call, int error) {
  const char* hint = error == EBUSY ? " (another program uses the device)" : "";
  return {
      is_absent(error) ? ErrorKind::no_input : ErrorKind::unavailable,
      fmt::format("'{}': {}: expected success, found: {}{}", path, call, std::generic_category().message(error), hint)};
}

}  // namespace scree::drivers::v4l2
