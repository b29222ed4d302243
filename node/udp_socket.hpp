#pragma once
// UDP over IPv4 and IPv6: the one place that knows the socket calls. Never fragments (DF), never blocks on sending.

#include <array>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>

#include "core/result.hpp"

namespace scree::node {

/// A numeric address and a port.
struct Endpoint {
  bool v6 = false;
  std::array<std::uint8_t, 16> address{};  ///< network order; IPv4 uses the first four
  std::uint16_t port = 0;

  bool same_address(const Endpoint& other) const { return v6 == other.v6 && address == other.address; }
  bool multicast() const { return v6 ? address[0] == 0xFF : (address[0] & 0xF0) == 0xE0; }
  bool any_address() const { return address == std::array<std::uint8_t, 16>{}; }
  friend bool operator==(const Endpoint&, const Endpoint&) = default;
};

/// "127.0.0.1:47800", "[::1]:47800", "localhost:47800". Names are not looked up. Error: usage, naming `what`.
Result<Endpoint> parse_endpoint(const std::string& text, const std::string& what);
/// The same without a port.
Result<Endpoint> parse_address(const std::string& text, const std::string& what);
std::string to_string(const Endpoint& endpoint);

/// How datagrams to a group leave.
struct MulticastWay {
  int ttl = 1;             ///< routers that they pass, plus 1
  std::string interface_;  ///< IPv4 address of the interface; empty = the kernel's choice
};

/// Receiving and sending may be done by two threads at once, each by one.
class UdpSocket {
 public:
  enum class Outcome : std::uint8_t { all, blocked, too_long, failed };
  struct Sent {
    std::size_t datagrams = 0;  ///< the first ones; `too_long` and `failed` speak of the one after them
    Outcome outcome = Outcome::all;
    int error = 0;  ///< errno
  };
  using Taker = std::function<void(std::span<const std::uint8_t> datagram, const Endpoint& from)>;

  /// A receiver on `local` (port 0: any free one), with DF set on what it sends. A multicast group is joined, on the
  /// interface whose IPv4 address `multicast_interface` is, and may be heard by several sockets of this machine.
  /// Errors: unavailable (`what` names the setting), usage (interface).
  static Result<UdpSocket> bind(const Endpoint& local, const std::string& what,
                                const std::string& multicast_interface = {});
  /// A sender to `destination` with DF set. `way` is for groups alone. Errors: unavailable, usage (interface).
  static Result<UdpSocket> connect_to(const Endpoint& destination, const std::string& what,
                                      const MulticastWay& way = {});
  UdpSocket(UdpSocket&&) noexcept;
  UdpSocket& operator=(UdpSocket&&) noexcept;
  ~UdpSocket();

  /// One sendmmsg for up to 64, to `to` or where the socket is connected to. Nobody listening (ECONNREFUSED) is not an
  /// error: the datagram counts as sent.
  Sent send(std::span<const std::span<const std::uint8_t>> datagrams, const Endpoint* to = nullptr);

  /// Waits at most `timeout` for a datagram, then hands on what is there, at most `kMaxPerCall` datagrams. Returns how
  /// many; a signal ends the wait. Datagrams beyond 2048 bytes arrive cut to that. Errors: io.
  Result<std::size_t> receive(std::chrono::milliseconds timeout, const Taker& take);
  static constexpr std::size_t kMaxPerCall = 4096;

  std::uint16_t local_port() const;
  /// Datagrams the kernel dropped because the receive buffer was full (SO_RXQ_OVFL).
  std::uint64_t overflowed() const;  // of the receiving thread

 private:
  struct State;
  explicit UdpSocket(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace scree::node
