#include "node/service_notify.hpp"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

namespace scree::node {
namespace {

std::optional<std::uint64_t> number_in(const char* variable) {
  const char* const text = std::getenv(variable);
  if (text == nullptr) return std::nullopt;
  std::uint64_t value = 0;
  const auto [end, status] = std::from_chars(text, text + std::strlen(text), value);
  if (status != std::errc{} || *end != '\0') return std::nullopt;
  return value;
}

/// Newlines separate assignments.
std::string one_line(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

}  // namespace

ServiceNotify::ServiceNotify() {
  const char* const address = std::getenv("NOTIFY_SOCKET");
  if (address == nullptr || (address[0] != '/' && address[0] != '@')) return;
  address_ = address;
  socket_ = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  const auto usec = number_in("WATCHDOG_USEC");
  const auto pid = number_in("WATCHDOG_PID");
  const bool for_us = !pid || *pid == static_cast<std::uint64_t>(::getpid());
  if (usec && *usec > 0 && for_us) watchdog_ = std::chrono::microseconds(*usec);
}

ServiceNotify::~ServiceNotify() {
  if (socket_ >= 0) ::close(socket_);
}

void ServiceNotify::send(const std::string& message) const {
  sockaddr_un to{};
  if (socket_ < 0 || address_.size() >= sizeof(to.sun_path)) return;
  to.sun_family = AF_UNIX;
  std::memcpy(to.sun_path, address_.data(), address_.size());
  if (address_[0] == '@') to.sun_path[0] = '\0';
  const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + address_.size());
  (void)::sendto(socket_, message.data(), message.size(), MSG_NOSIGNAL, reinterpret_cast<const sockaddr*>(&to), size);
}

void ServiceNotify::ready(const std::string& status) const {
  send("READY=1\nSTATUS=" + one_line(status));
}
void ServiceNotify::status(const std::string& status) const {
  send("STATUS=" + one_line(status));
}
void ServiceNotify::stopping() const {
  send("STOPPING=1");
}
void ServiceNotify::feed_watchdog() const {
  send("WATCHDOG=1");
}

}  // namespace scree::node
