#pragma once
// POSE_INPUT messages to a node or whoever else wants to know where the simulated robot is (docs/protocol.md).

#include <cstdint>
#include <string>

#include "core/result.hpp"
#include "drivers/frame/pose_track.hpp"
#include "node/protocol.hpp"
#include "node/udp_socket.hpp"

namespace scree::node {

class PoseOutput {
 public:
  /// Errors: usage (the address), unavailable.
  static Result<PoseOutput> open(const std::string& destination, std::uint32_t stream_id, std::uint64_t boot_id);

  /// Never blocks; what the kernel refuses is counted.
  void send(const StampedPose& pose);

  std::uint64_t sent() const { return sent_; }
  std::uint64_t failed() const { return failed_; }

 private:
  PoseOutput(UdpSocket socket, std::uint32_t stream_id, std::uint64_t boot_id)
      : socket_(std::move(socket)), stream_id_(stream_id), boot_id_(boot_id) {}

  UdpSocket socket_;
  std::uint32_t stream_id_;
  std::uint64_t boot_id_;
  std::uint64_t sent_ = 0, failed_ = 0;
};

}  // namespace scree::node
