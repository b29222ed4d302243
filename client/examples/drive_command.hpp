#pragma once
// Sends the drive commands of the simulated robot (docs/simulator.md). A robot of your own has its own; replace this.
// MIT licence, as the rest of Scree.

#include <cstdint>
#include <cstring>

#include "client/examples/path_planner.hpp"
#include "client/scree_client.hpp"

namespace scree_example {

/// UDP to one address; a command holds for half a second at the receiver.
class DriveSender {
 public:
  DriveSender() = default;
  DriveSender(const DriveSender&) = delete;
  DriveSender& operator=(const DriveSender&) = delete;
  ~DriveSender() {
    if (fd_ >= 0) ::close(fd_);
  }

  /// `address`: numeric ADDRESS:PORT. False: it cannot be used.
  bool open(const char* address) {
    if (!to_.parse(address) || to_.any() || to_.port() == 0) return false;
    fd_ = ::socket(to_.v6() ? AF_INET6 : AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    return fd_ >= 0 && ::getrandom(&boot_id_, sizeof boot_id_, 0) == static_cast<ssize_t>(sizeof boot_id_);
  }

  /// False: not sent (counted).
  bool send(const Drive& drive) {
    std::uint8_t out[36] = {'S', 'C', 'D', 'R', 1};
    put(out + 8, boot_id_, 8);
    put(out + 16, ++seq_, 8);
    put(out + 24, bits(static_cast<float>(drive.speed_mps)), 4);
    put(out + 28, bits(static_cast<float>(drive.curvature_per_m)), 4);
    put(out + 32, scree::client::detail::crc32(0, out, 32), 4);
    const bool sent = ::sendto(fd_, out, sizeof out, MSG_DONTWAIT, to_.get(), to_.size) == sizeof out;
    failed_ += sent ? 0U : 1U;
    return sent;
  }
  std::uint64_t sent() const { return seq_ - failed_; }
  std::uint64_t failed() const { return failed_; }

 private:
  static void put(std::uint8_t* p, std::uint64_t value, std::size_t bytes) {
    for (std::size_t i = 0; i < bytes; ++i) p[i] = static_cast<std::uint8_t>(value >> (8 * i));
  }
  static std::uint32_t bits(float value) {
    std::uint32_t out = 0;
    std::memcpy(&out, &value, sizeof out);
    return out;
  }

  int fd_ = -1;
  scree::client::detail::Address to_;
  std::uint64_t boot_id_ = 0, seq_ = 0, failed_ = 0;
};

}  // namespace scree_example
