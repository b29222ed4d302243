#pragma once
// Real datagrams for the tests of the client's socket.

#include <arpa/inet.h>
#include <netinet/in.h>
#include <span>
#include <string>
#include <sys/socket.h>
#include <unistd.h>

#include "node/protocol.hpp"

namespace scree::test {

/// A socket that sends to 127.0.0.1:port (or a multicast group over loopback).
class Sender {
 public:
  explicit Sender(std::uint16_t port, const std::string& host = "127.0.0.1")
      : fd_(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    to_.sin_family = AF_INET;
    to_.sin_port = htons(port);
    inet_pton(AF_INET, host.c_str(), &to_.sin_addr);
    in_addr loopback{htonl(INADDR_LOOPBACK)};
    setsockopt(fd_, IPPROTO_IP, IP_MULTICAST_IF, &loopback, sizeof loopback);
  }
  Sender(const Sender&) = delete;
  Sender& operator=(const Sender&) = delete;
  ~Sender() { close(fd_); }

  bool send(std::span<const std::uint8_t> bytes) const {
    return sendto(fd_, bytes.data(), bytes.size(), 0, reinterpret_cast<const sockaddr*>(&to_), sizeof to_) ==
           static_cast<ssize_t>(bytes.size());
  }
  bool heartbeat(std::uint64_t seq) const {
    node::protocol::Header header;
    header.stream_id = 1;
    header.boot_id = 0x5EED;
    header.seq = seq;
    node::protocol::Datagram datagram;
    encode(header, node::protocol::Heartbeat{}, datagram);
    return send(datagram.view());
  }

 private:
  int fd_;
  sockaddr_in to_{};
};

}  // namespace scree::test
