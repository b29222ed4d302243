#include "node/pose_output.hpp"

#include <span>
#include <utility>

namespace scree::node {

Result<PoseOutput> PoseOutput::open(const std::string& destination, std::uint32_t stream_id, std::uint64_t boot_id) {
  const auto endpoint = parse_endpoint(destination, "--pose-out");
  if (!endpoint) return endpoint.error();
  auto socket = UdpSocket::connect_to(*endpoint, "--pose-out");
  if (!socket) return socket.error();
  return PoseOutput(*std::move(socket), stream_id, boot_id);
}

void PoseOutput::send(const StampedPose& pose) {
  protocol::Header header;
  header.stream_id = stream_id_;
  header.boot_id = boot_id_;
  header.seq = sent_ + failed_ + 1;
  header.origin = drivers::Origin::sim;
  protocol::PoseInputMessage message;
  message.time = pose.time;
  message.T_map_body = pose.T_map_body;
  protocol::Datagram datagram;
  encode(header, message, datagram);
  const std::span<const std::uint8_t> view = datagram.view();
  const bool gone = socket_.send(std::span(&view, 1)).datagrams == 1;
  ++(gone ? sent_ : failed_);
}

}  // namespace scree::node
