#include "tests/support/udp_relay.hpp"

#include <algorithm>
#include <arpa/inet.h>
#include <array>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

namespace scree::test {
namespace {

int bound_socket(const sockaddr_in& address) {
  const int fd = socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  const int buffer = 8 << 20;
  (void)setsockopt(fd, SOL_SOCKET, SO_RCVBUF, &buffer, sizeof buffer);
  if (bind(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0) return fd;
  close(fd);
  return -1;
}

std::uint16_t port_of(int fd) {
  sockaddr_in address{};
  socklen_t size = sizeof address;
  (void)getsockname(fd, reinterpret_cast<sockaddr*>(&address), &size);
  return ntohs(address.sin_port);
}

Nanoseconds monotonic() {
  return std::chrono::duration_cast<Nanoseconds>(std::chrono::steady_clock::now().time_since_epoch());
}

}  // namespace

std::optional<sockaddr_in> parse_ipv4(const std::string& text) {
  const std::size_t colon = text.rfind(':');
  sockaddr_in out{};
  out.sin_family = AF_INET;
  if (colon == std::string::npos || inet_pton(AF_INET, text.substr(0, colon).c_str(), &out.sin_addr) != 1) return {};
  char* end = nullptr;
  const unsigned long port = std::strtoul(text.c_str() + colon + 1, &end, 10);
  if (end == text.c_str() + colon + 1 || *end != '\0' || port > 65535) return {};
  out.sin_port = htons(static_cast<std::uint16_t>(port));
  return out;
}

std::unique_ptr<UdpRelay> UdpRelay::open(const UdpRelaySettings& settings) {
  const int near = bound_socket(settings.near), far = bound_socket(settings.far);
  if (near < 0 || far < 0) {
    if (near >= 0) close(near);
    if (far >= 0) close(far);
    return nullptr;
  }
  return std::unique_ptr<UdpRelay>(new UdpRelay(settings, near, far));
}

UdpRelay::UdpRelay(const UdpRelaySettings& settings, int near, int far)
    : settings_(settings),
      near_(near),
      far_(far),
      down_(settings.down, settings.seed),
      up_(settings.up, settings.seed + 1) {}

UdpRelay::~UdpRelay() {
  thread_ = {};  // stopped and joined before the sockets go
  close(near_);
  close(far_);
}

std::uint16_t UdpRelay::near_port() const {
  return port_of(near_);
}
std::uint16_t UdpRelay::far_port() const {
  return port_of(far_);
}

void UdpRelay::take(int fd, BadNetwork& way, bool from_client, Nanoseconds now) {
  std::array<std::uint8_t, 2048> buffer;
  for (;;) {
    sockaddr_in from{};
    socklen_t size = sizeof from;
    const ssize_t count =
        recvfrom(fd, buffer.data(), buffer.size(), MSG_DONTWAIT, reinterpret_cast<sockaddr*>(&from), &size);
    if (count < 0) return;
    if (from_client && !settings_.client) settings_.client = from;
    way.send(std::span(buffer).first(static_cast<std::size_t>(count)), now);
  }
}

void UdpRelay::give(int fd, std::span<const std::uint8_t> bytes, const std::optional<sockaddr_in>& to) {
  if (!to) {
    ++without_destination_;
    return;
  }
  (void)sendto(fd, bytes.data(), bytes.size(), 0, reinterpret_cast<const sockaddr*>(&*to), sizeof *to);
}

void UdpRelay::run_once(std::chrono::milliseconds timeout) {
  const Nanoseconds due = std::min(down_.next_due(), up_.next_due());
  Nanoseconds wait = timeout;
  if (due != Nanoseconds::max()) wait = std::clamp(due - monotonic(), Nanoseconds{0}, wait);
  std::array<pollfd, 2> sockets{{{near_, POLLIN, 0}, {far_, POLLIN, 0}}};
  const timespec limit{wait.count() / 1'000'000'000, wait.count() % 1'000'000'000};
  (void)ppoll(sockets.data(), sockets.size(), &limit, nullptr);
  down_.set_black_out(black_out_);
  up_.set_black_out(black_out_);
  const Nanoseconds now = monotonic();
  take(near_, up_, true, now);
  take(far_, down_, false, now);
  up_.deliver(now, [&](auto bytes) { give(far_, bytes, settings_.node); });
  down_.deliver(now, [&](auto bytes) { give(near_, bytes, settings_.client); });
}

void UdpRelay::start() {
  thread_ = std::jthread([this](const std::stop_token& stop) {
    while (!stop.stop_requested()) run_once(std::chrono::milliseconds(20));
  });
}

}  // namespace scree::test
