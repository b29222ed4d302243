#include "node/udp_socket.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fmt/format.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>
#include <vector>

#include "node/udp_options.hpp"

namespace scree::node {
namespace {

constexpr int kReceiveBufferBytes = 8 << 20;  // the kernel gives what rmem_max allows
constexpr int kSendBufferBytes = 1 << 20;
constexpr std::size_t kBatch = 64;
constexpr std::size_t kReceiveBytes = 2048;

/// A sockaddr of either family; copied with memcpy, as the socket interface demands.
struct SocketAddress {
  sockaddr_storage storage{};
  socklen_t size = 0;
  const sockaddr* get() const { return reinterpret_cast<const sockaddr*>(&storage); }
};

SocketAddress to_socket_address(const Endpoint& endpoint) {
  SocketAddress out;
  if (endpoint.v6) {
    sockaddr_in6 address{};
    address.sin6_family = AF_INET6;
    address.sin6_port = htons(endpoint.port);
    std::memcpy(&address.sin6_addr, endpoint.address.data(), 16);
    out.size = sizeof address;
    std::memcpy(&out.storage, &address, sizeof address);
  } else {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(endpoint.port);
    std::memcpy(&address.sin_addr, endpoint.address.data(), 4);
    out.size = sizeof address;
    std::memcpy(&out.storage, &address, sizeof address);
  }
  return out;
}

Endpoint from_socket_address(const sockaddr_storage& storage) {
  Endpoint out;
  out.v6 = storage.ss_family == AF_INET6;
  if (out.v6) {
    sockaddr_in6 address;
    std::memcpy(&address, &storage, sizeof address);
    std::memcpy(out.address.data(), &address.sin6_addr, 16);
    out.port = ntohs(address.sin6_port);
  } else {
    sockaddr_in address;
    std::memcpy(&address, &storage, sizeof address);
    std::memcpy(out.address.data(), &address.sin_addr, 4);
    out.port = ntohs(address.sin_port);
  }
  return out;
}

int open_socket(const Endpoint& endpoint) {
  return socket(endpoint.v6 ? AF_INET6 : AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
}

std::uint32_t overflow_count(msghdr& message, std::uint32_t before) {
  std::uint32_t count = before;
  for (cmsghdr* item = CMSG_FIRSTHDR(&message); item != nullptr; item = CMSG_NXTHDR(&message, item))
    if (item->cmsg_level == SOL_SOCKET && item->cmsg_type == SO_RXQ_OVFL)
      std::memcpy(&count, CMSG_DATA(item), sizeof count);
  return count;
}

}  // namespace

struct UdpSocket::State {
  int fd = -1;
  std::uint32_t overflowed = 0;
  // receive buffers, one slot a datagram
  std::vector<std::array<std::uint8_t, kReceiveBytes>> buffers;
  std::array<mmsghdr, kBatch> messages{};
  std::array<iovec, kBatch> vectors{};
  std::array<sockaddr_storage, kBatch> senders{};
  std::array<std::array<std::uint8_t, CMSG_SPACE(sizeof(std::uint32_t))>, kBatch> control{};

  explicit State(int socket) : fd(socket) {}
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State() { close(fd); }

  int receive_batch();
};

UdpSocket::UdpSocket(std::unique_ptr<State> state) : state_(std::move(state)) {}
UdpSocket::UdpSocket(UdpSocket&&) noexcept = default;
UdpSocket& UdpSocket::operator=(UdpSocket&&) noexcept = default;
UdpSocket::~UdpSocket() = default;

Result<UdpSocket> UdpSocket::bind(const Endpoint& local, const std::string& what,
                                  const std::string& multicast_interface) {
  auto state = std::make_unique<State>(open_socket(local));
  if (state->fd < 0) return unavailable(what, local, errno);
  if (local.multicast()) set_option(state->fd, SOL_SOCKET, SO_REUSEADDR, 1);  // one group, many members on a machine
  const SocketAddress address = to_socket_address(local);
  if (::bind(state->fd, address.get(), address.size) != 0) return unavailable(what, local, errno);
  set_option(state->fd, SOL_SOCKET, SO_RCVBUF, kReceiveBufferBytes);
  set_option(state->fd, SOL_SOCKET, SO_SNDBUF, kSendBufferBytes);
  set_option(state->fd, SOL_SOCKET, SO_RXQ_OVFL, 1);
  if (auto set = set_df(state->fd, local, what); !set) return set.error();
  if (local.multicast())
    if (auto joined = join_group(state->fd, local, what, multicast_interface); !joined) return joined.error();
  state->buffers.resize(kBatch);
  return UdpSocket(std::move(state));
}

Result<UdpSocket> UdpSocket::connect_to(const Endpoint& destination, const std::string& what, const MulticastWay& way) {
  auto state = std::make_unique<State>(open_socket(destination));
  if (state->fd < 0) return unavailable(what, destination, errno);
  if (destination.multicast())  // before connecting: it decides the local address
    if (auto set = set_multicast_way(state->fd, destination, what, way); !set) return set.error();
  const SocketAddress address = to_socket_address(destination);
  if (connect(state->fd, address.get(), address.size) != 0) return unavailable(what, destination, errno);
  set_option(state->fd, SOL_SOCKET, SO_SNDBUF, kSendBufferBytes);
  if (auto set = set_df(state->fd, destination, what); !set) return set.error();
  return UdpSocket(std::move(state));
}

UdpSocket::Sent UdpSocket::send(std::span<const std::span<const std::uint8_t>> datagrams, const Endpoint* to) {
  SocketAddress address = to != nullptr ? to_socket_address(*to) : SocketAddress{};
  Sent result;
  int refusals = 0;
  while (result.datagrams < datagrams.size()) {
    std::array<mmsghdr, kBatch> messages{};
    std::array<iovec, kBatch> vectors{};
    const std::size_t count = std::min(kBatch, datagrams.size() - result.datagrams);
    for (std::size_t i = 0; i < count; ++i) {
      const auto datagram = datagrams[result.datagrams + i];
      vectors[i] = {const_cast<std::uint8_t*>(datagram.data()), datagram.size()};  // sendmmsg does not write
      messages[i].msg_hdr.msg_iov = &vectors[i];
      messages[i].msg_hdr.msg_iovlen = 1;
      if (to == nullptr) continue;
      messages[i].msg_hdr.msg_name = &address.storage;
      messages[i].msg_hdr.msg_namelen = address.size;
    }
    const int sent = sendmmsg(state_->fd, messages.data(), static_cast<unsigned>(count), MSG_DONTWAIT);
    if (sent > 0) {
      result.datagrams += static_cast<std::size_t>(sent);
      continue;
    }
    if (errno == EINTR) continue;
    if (errno == ECONNREFUSED) {  // an earlier datagram met no listener; reporting it sent nothing, so try again once
      if (++refusals % 2 == 0) ++result.datagrams;
      continue;
    }
    result.error = errno;
    result.outcome = errno == EAGAIN || errno == EWOULDBLOCK || errno == ENOBUFS ? Outcome::blocked
                     : errno == EMSGSIZE                                         ? Outcome::too_long
                                                                                 : Outcome::failed;
    return result;
  }
  return result;
}

int UdpSocket::State::receive_batch() {
  for (std::size_t i = 0; i < kBatch; ++i) {
    vectors[i] = {buffers[i].data(), buffers[i].size()};
    msghdr& header = messages[i].msg_hdr;
    header = {};
    header.msg_name = &senders[i];
    header.msg_namelen = sizeof senders[i];
    header.msg_iov = &vectors[i];
    header.msg_iovlen = 1;
    header.msg_control = control[i].data();
    header.msg_controllen = control[i].size();
  }
  return recvmmsg(fd, messages.data(), kBatch, MSG_DONTWAIT, nullptr);
}

Result<std::size_t> UdpSocket::receive(std::chrono::milliseconds timeout, const Taker& take) {
  pollfd waiting{state_->fd, POLLIN, 0};
  const int ready = poll(&waiting, 1, static_cast<int>(std::clamp<std::int64_t>(timeout.count(), 0, 1 << 30)));
  if (ready == 0 || (ready < 0 && errno == EINTR)) return std::size_t{0};
  if (ready < 0) return Error{ErrorKind::io, fmt::format("UDP socket: poll failed: {}", std::strerror(errno))};
  std::size_t taken = 0;
  while (taken < kMaxPerCall) {
    const int count = state_->receive_batch();
    if (count < 0) {
      if (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR || errno == ECONNREFUSED) break;
      return Error{ErrorKind::io, fmt::format("UDP socket: recvmmsg failed: {}", std::strerror(errno))};
    }
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
      mmsghdr& message = state_->messages[i];
      state_->overflowed = overflow_count(message.msg_hdr, state_->overflowed);
      take(std::span(state_->buffers[i]).first(message.msg_len), from_socket_address(state_->senders[i]));
    }
    taken += static_cast<std::size_t>(count);
    if (static_cast<std::size_t>(count) < kBatch) break;
  }
  return taken;
}

std::uint16_t UdpSocket::local_port() const {
  sockaddr_storage storage{};
  socklen_t size = sizeof storage;
  if (getsockname(state_->fd, reinterpret_cast<sockaddr*>(&storage), &size) != 0) return 0;
  return from_socket_address(storage).port;
}

std::uint64_t UdpSocket::overflowed() const {
  return state_->overflowed;
}

}  // namespace scree::node
