#pragma once
// What comes in at publish.listen: poses go to the pose input, requests to the queue of the publisher. Used by one
// thread, the one that receives.

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>

#include "core/result.hpp"
#include "node/pose_input.hpp"
#include "node/requests.hpp"
#include "node/udp_socket.hpp"

namespace scree::node {

struct InboxCounters {
  RequestCounters requests;  ///< what is no POSE_INPUT, garbage too
  PoseInputCounters poses;
  std::uint64_t overflowed = 0;  ///< dropped by the kernel: receive buffer full

  std::uint64_t rejected() const { return requests.rejected + poses.rejected; }
};

class Inbox {
 public:
  /// Binds `listen` ("127.0.0.1:47801"; port 0 = any free one). Poses are taken from the address `accept_from` alone
  /// (any port of it); empty = the loopback address of `listen`'s family. With `keys`, what has no MAC of one of them
  /// is refused. Errors: unavailable (port taken), usage (not an address, or every address at once).
  static Result<std::unique_ptr<Inbox>> open(const std::string& listen, const std::string& accept_from,
                                             std::uint32_t stream_id, const protocol::KeyRing& keys = {});

  /// Receives for at most `timeout`. True when a request was put into `queue`. Errors: io.
  Result<bool> poll(std::chrono::milliseconds timeout, RequestQueue& queue);

  PoseInput& poses() { return poses_; }
  /// To answer by: what clients hear comes from where they asked.
  std::shared_ptr<UdpSocket> socket() const { return socket_; }
  std::uint16_t port() const { return socket_->local_port(); }
  InboxCounters counters() const;

 private:
  Inbox(std::shared_ptr<UdpSocket> socket, const Endpoint& accept_from, std::uint32_t stream_id,
        const protocol::KeyRing& keys)
      : socket_(std::move(socket)), poses_(PoseReceiver(accept_from, stream_id, keys)), reader_(stream_id, keys) {}

  std::shared_ptr<UdpSocket> socket_;
  PoseInput poses_;
  RequestReader reader_;
  Request request_;  ///< scratch
};

}  // namespace scree::node
