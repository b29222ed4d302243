#pragma once
// Byte streams of this machine: unix sockets, and TCP on the loopback. stream_socket.cpp is the one place that knows
// the calls. Nothing here blocks longer than it is told to.

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "core/result.hpp"

namespace scree::drivers {

inline constexpr std::string_view kStreamAddressGrammar = "unix:PATH or tcp:[HOST:]PORT with a HOST of this machine";

struct StreamAddress {
  enum class Kind : std::uint8_t { unix_path, tcp4, tcp6 };
  Kind kind = Kind::unix_path;
  std::string host;  ///< unix: the path; tcp: a numeric loopback address
  std::uint16_t port = 0;
};

/// "unix:/run/scanner.sock", "tcp:47810", "tcp:127.0.0.1:47810", "tcp:localhost:0", "tcp:[::1]:47810". Errors: usage
/// (the grammar; a host that is not the loopback; a path longer than a unix socket's name can be), naming `what`.
Result<StreamAddress> parse_stream_address(const std::string& text, const std::string& what);
/// The unix socket at `path`, which stood behind `scheme` ("unix:"). Errors: usage (no path, or one that is too long).
Result<StreamAddress> unix_address(const std::string& path, std::string_view scheme, const std::string& what);
std::string to_string(const StreamAddress& address);

/// One end of a connection, or a listener. Closed at destruction.
class StreamSocket {
 public:
  struct Moved {
    std::size_t bytes = 0;
    bool closed = false;  ///< by the other end, or broken; `bytes` of it still hold
  };

  /// Errors: unavailable, naming the address and why.
  static Result<StreamSocket> connect_to(const StreamAddress& address, std::chrono::milliseconds timeout);
  /// A unix socket that a dead process left behind is taken over. Errors: unavailable (in use, or not allowed).
  static Result<StreamSocket> listen_at(const StreamAddress& address);
  StreamSocket(StreamSocket&& other) noexcept;
  StreamSocket& operator=(StreamSocket&& other) noexcept;
  ~StreamSocket();

  /// Of a listener: who waits, if anyone does.
  std::optional<StreamSocket> accept();
  /// Waits at most `timeout` for the first byte, then takes what is there.
  Moved read(std::span<std::uint8_t> into, std::chrono::milliseconds timeout);
  /// Hands over what there is room for now.
  Moved write(std::span<const std::uint8_t> bytes);
  /// Of a TCP listener: its port, also where the kernel chose it.
  std::uint16_t local_port() const;

 private:
  explicit StreamSocket(int fd) : fd_(fd) {}
  void close();

  int fd_ = -1;
  std::string unlink_path_;  ///< of a listening unix socket
};

}  // namespace scree::drivers
