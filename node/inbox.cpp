#include "node/inbox.hpp"

namespace scree::node {
namespace {

/// By the type byte alone: whoever takes it checks it.
bool looks_like_pose(std::span<const std::uint8_t> datagram) {
  return datagram.size() > 6 && datagram[6] == static_cast<std::uint8_t>(protocol::MessageType::pose_input);
}

}  // namespace

Result<std::unique_ptr<Inbox>> Inbox::open(const std::string& listen, const std::string& accept_from,
                                           std::uint32_t stream_id, const protocol::KeyRing& keys) {
  const auto local = parse_endpoint(listen, "publish.listen");
  if (!local) return local.error();
  if (local->any_address() || local->multicast())
    return Error{ErrorKind::usage,
                 "publish.listen: expected one address of this machine, found '" + listen + "', which is none"};
  const auto from =
      parse_address(accept_from.empty() ? (local->v6 ? "::1" : "127.0.0.1") : accept_from, "pose.accept_from");
  if (!from) return from.error();
  auto socket = UdpSocket::bind(*local, "publish.listen");
  if (!socket) return socket.error();
  return std::unique_ptr<Inbox>(new Inbox(std::make_shared<UdpSocket>(std::move(*socket)), *from, stream_id, keys));
}

Result<bool> Inbox::poll(std::chrono::milliseconds timeout, RequestQueue& queue) {
  bool requested = false;
  const auto count = socket_->receive(timeout, [&](std::span<const std::uint8_t> datagram, const Endpoint& from) {
    const MonotonicTime arrived = MonotonicClock::now();
    const Time arrived_at = std::chrono::time_point_cast<Duration>(std::chrono::system_clock::now());
    if (looks_like_pose(datagram)) {
      poses_.accept(datagram, from, arrived_at, arrived);
      return;
    }
    if (reader_.read(datagram, from, request_) != protocol::Reject::none) return;
    request_.arrived = arrived;
    request_.arrived_at = arrived_at;
    queue.push(request_);
    requested = true;
  });
  if (!count) return count.error();
  return requested;
}

InboxCounters Inbox::counters() const {
  return {reader_.counters(), poses_.counters(), socket_->overflowed()};
}

}  // namespace scree::node
