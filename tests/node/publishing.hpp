#pragma once
// Publishers for the tests, over real loopback sockets, on ports that the kernel chooses.

#include <chrono>
#include <gtest/gtest.h>
#include <memory>
#include <span>
#include <string>

#include "node/listener.hpp"
#include "node/publisher.hpp"
#include "node/udp_socket.hpp"

namespace scree::test {

using node::Endpoint;
using node::Listener;
using node::NodeStatus;
using node::parse_endpoint;
using node::Publisher;
using node::UdpSocket;

inline constexpr LatticeWindow kWindow{{-70, 13}, 130, 200};  // 8 × 5 tiles, not aligned

inline std::unique_ptr<Listener> open_listener(std::uint16_t port = 0) {
  auto listener = Listener::open("127.0.0.1:" + std::to_string(port), {drivers::Origin::live, drivers::Origin::replay});
  EXPECT_TRUE(listener) << listener.error().message;
  return std::move(*listener);
}

inline config::PublishSettings settings_for(std::uint16_t port) {
  config::PublishSettings settings;
  settings.destination = "127.0.0.1:" + std::to_string(port);
  settings.refresh_ms = 200;
  return settings;
}

inline std::unique_ptr<Publisher> open_publisher(const config::PublishSettings& settings) {
  auto publisher = Publisher::open(settings, drivers::Origin::live, 0.1, 0x01020304);
  EXPECT_TRUE(publisher) << publisher.error().message;
  return std::move(*publisher);
}

inline NodeStatus status() {
  NodeStatus out;
  out.frames_in = 12;
  return out;
}

/// Takes what a publisher sends and hands it on to a function.
struct Tap {
  UdpSocket socket;
  Tap() : socket(std::move(*UdpSocket::bind(*parse_endpoint("127.0.0.1:0", "tap"), "tap"))) {}
  template <class Take>
  void drain(Take take) {
    EXPECT_TRUE(socket.receive(std::chrono::milliseconds(0),
                               [&](std::span<const std::uint8_t> bytes, const Endpoint&) { take(bytes); }));
  }
};

}  // namespace scree::test
