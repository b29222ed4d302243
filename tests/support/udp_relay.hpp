#pragma once
// A bad network between real sockets: stands between a node and one client. The client's side is `near`: requests that
// come there go to the node; what comes to `far` (from the node) goes to the client, which is `client`, or whoever last
// sent to `near`.

#include <atomic>
#include <netinet/in.h>
#include <optional>
#include <string>
#include <thread>

#include "tests/support/bad_network.hpp"

namespace scree::test {

struct UdpRelaySettings {
  sockaddr_in near{};                 ///< bind; port 0 = any free one
  sockaddr_in far{};                  ///< bind; the destination of a node that sends without subscription
  std::optional<sockaddr_in> node;    ///< where requests go
  std::optional<sockaddr_in> client;  ///< where maps go; without it the last who sent to `near`
  BadNetworkSettings down, up;        ///< node → client, client → node
  std::uint64_t seed = 1;
};

/// "127.0.0.1:47800"; nullopt for anything else.
std::optional<sockaddr_in> parse_ipv4(const std::string& text);

class UdpRelay {
 public:
  /// Null when a socket cannot be bound.
  static std::unique_ptr<UdpRelay> open(const UdpRelaySettings& settings);
  ~UdpRelay();

  /// Relays what is there and what is due, then waits at most `timeout` for more.
  void run_once(std::chrono::milliseconds timeout);
  /// run_once in a thread of its own until destruction; the settings may not be touched meanwhile but for black-outs.
  void start();
  void set_black_out(bool on) { black_out_ = on; }

  std::uint16_t near_port() const;
  std::uint16_t far_port() const;
  const BadNetworkCounters& down() const { return down_.counters(); }
  const BadNetworkCounters& up() const { return up_.counters(); }
  std::uint64_t without_destination() const { return without_destination_; }

 private:
  UdpRelay(const UdpRelaySettings& settings, int near, int far);
  void take(int fd, BadNetwork& way, bool from_client, Nanoseconds now);
  void give(int fd, std::span<const std::uint8_t> bytes, const std::optional<sockaddr_in>& to);

  UdpRelaySettings settings_;
  int near_, far_;
  BadNetwork down_, up_;
  std::uint64_t without_destination_ = 0;  ///< nobody to send to yet
  std::atomic<bool> black_out_{false};
  std::jthread thread_;
};

}  // namespace scree::test
