#include "drivers/stream_socket.hpp"

#include <algorithm>
#include <arpa/inet.h>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <fmt/format.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>
#include <utility>

namespace scree::drivers {
namespace {

constexpr int kBufferBytes = 4 << 20;  // a wish: the kernel gives what it allows

struct SocketName {
  sockaddr_storage storage{};
  socklen_t size = 0;
  const sockaddr* get() const { return reinterpret_cast<const sockaddr*>(&storage); }
};

template <class Address>
SocketName named(const Address& address) {
  SocketName name;
  std::memcpy(&name.storage, &address, sizeof address);
  name.size = sizeof address;
  return name;
}

SocketName name_of(const StreamAddress& address) {
  if (address.kind == StreamAddress::Kind::unix_path) {
    sockaddr_un name{};
    name.sun_family = AF_UNIX;
    std::memcpy(name.sun_path, address.host.data(), std::min(address.host.size(), sizeof name.sun_path - 1));
    return named(name);
  }
  if (address.kind == StreamAddress::Kind::tcp4) {
    sockaddr_in name{};
    name.sin_family = AF_INET;
    name.sin_port = htons(address.port);
    inet_pton(AF_INET, address.host.c_str(), &name.sin_addr);
    return named(name);
  }
  sockaddr_in6 name{};
  name.sin6_family = AF_INET6;
  name.sin6_port = htons(address.port);
  inet_pton(AF_INET6, address.host.c_str(), &name.sin6_addr);
  return named(name);
}

/// The family of a numeric loopback address; nothing for any other host.
std::optional<StreamAddress::Kind> loopback(const std::string& host) {
  in_addr v4{};
  if (inet_pton(AF_INET, host.c_str(), &v4) == 1 && (ntohl(v4.s_addr) >> 24) == 127) return StreamAddress::Kind::tcp4;
  in6_addr v6{};
  if (inet_pton(AF_INET6, host.c_str(), &v6) == 1 && IN6_IS_ADDR_LOOPBACK(&v6)) return StreamAddress::Kind::tcp6;
  return std::nullopt;
}

Error unavailable(const StreamAddress& address, const std::string& why) {
  return {ErrorKind::unavailable, fmt::format("{}: {}", to_string(address), why)};
}

int open_socket(StreamAddress::Kind kind) {
  const int family = kind == StreamAddress::Kind::unix_path ? AF_UNIX
                     : kind == StreamAddress::Kind::tcp4    ? AF_INET
                                                            : AF_INET6;
  const int fd = ::socket(family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (fd < 0) return fd;
  const int on = 1;
  for (const int option : {SO_SNDBUF, SO_RCVBUF})
    (void)setsockopt(fd, SOL_SOCKET, option, &kBufferBytes, sizeof kBufferBytes);
  if (family != AF_UNIX) {
    (void)setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
    (void)setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  }
  return fd;
}

/// A socket in the file system that refuses connections belongs to a dead process; any other file is somebody's.
bool left_behind(const StreamAddress& address) {
  const SocketName name = name_of(address);
  struct stat file {};
  const bool is_socket = ::lstat(address.host.c_str(), &file) == 0 && S_ISSOCK(file.st_mode);
  const int probe = open_socket(address.kind);
  const bool refused = ::connect(probe, name.get(), name.size) != 0 && errno == ECONNREFUSED;
  ::close(probe);
  errno = EADDRINUSE;
  return is_socket && refused;
}

bool ready(int fd, short events, std::chrono::milliseconds timeout) {
  pollfd waiting{fd, events, 0};
  return poll(&waiting, 1, static_cast<int>(std::clamp<std::int64_t>(timeout.count(), 0, 1 << 30))) > 0;
}

bool try_again(int error) {
  return error == EAGAIN || error == EWOULDBLOCK || error == EINTR;
}

}  // namespace

Result<StreamAddress> unix_address(const std::string& path, std::string_view scheme, const std::string& what) {
  constexpr std::size_t kMaxPath = sizeof(sockaddr_un::sun_path) - 1;
  if (path.empty() || path.size() > kMaxPath)
    return Error{ErrorKind::usage, fmt::format("{}: expected a path of 1 … {} bytes behind {}, found '{}{}'", what,
                                               kMaxPath, scheme, scheme, path)};
  StreamAddress address;
  address.host = path;
  return address;
}

Result<StreamAddress> parse_stream_address(const std::string& text, const std::string& what) {
  const auto wrong = [&](const std::string& expected) {
    return Error{ErrorKind::usage, fmt::format("{}: expected {}, found '{}'", what, expected, text)};
  };
  if (text.starts_with("unix:")) return unix_address(text.substr(5), "unix:", what);
  if (!text.starts_with("tcp:")) return wrong(std::string(kStreamAddressGrammar));
  StreamAddress address;
  const std::string rest = text.substr(4);
  const std::size_t colon = rest.rfind(':');
  std::string host = colon == std::string::npos ? "127.0.0.1" : rest.substr(0, colon);
  const std::string port = colon == std::string::npos ? rest : rest.substr(colon + 1);
  const auto [end, status] = std::from_chars(port.data(), port.data() + port.size(), address.port);
  if (status != std::errc{} || end != port.data() + port.size()) return wrong("a port of 0 … 65535 behind tcp:");
  if (host == "localhost") host = "127.0.0.1";
  if (host.starts_with('[') && host.ends_with(']')) host = host.substr(1, host.size() - 2);
  const auto kind = loopback(host);
  if (!kind) return wrong("an address of the loopback such as 127.0.0.1 (frames are not signed)");
  address.kind = *kind;
  address.host = std::move(host);
  return address;
}

std::string to_string(const StreamAddress& address) {
  switch (address.kind) {
    case StreamAddress::Kind::unix_path:
      return "unix:" + address.host;
    case StreamAddress::Kind::tcp4:
      return fmt::format("tcp:{}:{}", address.host, address.port);
    case StreamAddress::Kind::tcp6:
      return fmt::format("tcp:[{}]:{}", address.host, address.port);
  }
  return "";
}

Result<StreamSocket> StreamSocket::connect_to(const StreamAddress& address, std::chrono::milliseconds timeout) {
  StreamSocket made(open_socket(address.kind));
  if (made.fd_ < 0) return unavailable(address, std::strerror(errno));
  const SocketName name = name_of(address);
  if (::connect(made.fd_, name.get(), name.size) == 0) return made;
  if (errno != EINPROGRESS) return unavailable(address, std::strerror(errno));
  if (!ready(made.fd_, POLLOUT, timeout)) return unavailable(address, "no answer");
  int error = 0;
  socklen_t size = sizeof error;
  (void)getsockopt(made.fd_, SOL_SOCKET, SO_ERROR, &error, &size);
  if (error != 0) return unavailable(address, std::strerror(error));
  return made;
}

Result<StreamSocket> StreamSocket::listen_at(const StreamAddress& address) {
  StreamSocket made(open_socket(address.kind));
  if (made.fd_ < 0) return unavailable(address, std::strerror(errno));
  const SocketName name = name_of(address);
  const bool is_path = address.kind == StreamAddress::Kind::unix_path;
  int bound = ::bind(made.fd_, name.get(), name.size);
  if (bound != 0 && errno == EADDRINUSE && is_path && left_behind(address)) {
    ::unlink(address.host.c_str());
    bound = ::bind(made.fd_, name.get(), name.size);
  }
  if (bound != 0 || ::listen(made.fd_, 8) != 0)
    return unavailable(address, fmt::format("expected a free address, found: {}", std::strerror(errno)));
  if (is_path) made.unlink_path_ = address.host;
  return made;
}

StreamSocket::StreamSocket(StreamSocket&& other) noexcept
    : fd_(std::exchange(other.fd_, -1)), unlink_path_(std::exchange(other.unlink_path_, {})) {}

StreamSocket& StreamSocket::operator=(StreamSocket&& other) noexcept {
  if (this == &other) return *this;
  close();
  fd_ = std::exchange(other.fd_, -1);
  unlink_path_ = std::exchange(other.unlink_path_, {});
  return *this;
}

StreamSocket::~StreamSocket() {
  close();
}

void StreamSocket::close() {
  if (fd_ >= 0) ::close(fd_);
  if (!unlink_path_.empty()) ::unlink(unlink_path_.c_str());
  fd_ = -1;
}

std::optional<StreamSocket> StreamSocket::accept() {
  const int fd = ::accept4(fd_, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC);
  if (fd < 0) return std::nullopt;
  (void)setsockopt(fd, SOL_SOCKET, SO_SNDBUF, &kBufferBytes, sizeof kBufferBytes);
  return StreamSocket(fd);
}

StreamSocket::Moved StreamSocket::read(std::span<std::uint8_t> into, std::chrono::milliseconds timeout) {
  if (!ready(fd_, POLLIN, timeout)) return {};
  const ssize_t count = ::recv(fd_, into.data(), into.size(), 0);
  if (count < 0) return {0, !try_again(errno)};
  return {static_cast<std::size_t>(count), count == 0};
}

StreamSocket::Moved StreamSocket::write(std::span<const std::uint8_t> bytes) {
  Moved moved;
  while (moved.bytes < bytes.size()) {
    const ssize_t count = ::send(fd_, bytes.data() + moved.bytes, bytes.size() - moved.bytes, MSG_NOSIGNAL);
    if (count < 0) {
      moved.closed = !try_again(errno);
      return moved;
    }
    moved.bytes += static_cast<std::size_t>(count);
  }
  return moved;
}

std::uint16_t StreamSocket::local_port() const {
  sockaddr_storage storage{};
  socklen_t size = sizeof storage;
  if (getsockname(fd_, reinterpret_cast<sockaddr*>(&storage), &size) != 0) return 0;
  if (storage.ss_family == AF_INET) {
    sockaddr_in name{};
    std::memcpy(&name, &storage, sizeof name);
    return ntohs(name.sin_port);
  }
  if (storage.ss_family != AF_INET6) return 0;
  sockaddr_in6 name{};
  std::memcpy(&name, &storage, sizeof name);
  return ntohs(name.sin6_port);
}

}  // namespace scree::drivers
