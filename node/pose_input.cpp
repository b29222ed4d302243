#include "node/pose_input.hpp"

#include <algorithm>

namespace scree::node {
namespace {

using protocol::Reject;

constexpr Duration kClockTolerance = std::chrono::seconds(1);

PoseVariance variance_of(const protocol::PoseInputMessage& message) {
  const auto& v = message.variances;
  const auto wide = [](float x) { return static_cast<double>(x); };
  return {{wide(v[0]), wide(v[1]), wide(v[2])}, {wide(v[3]), wide(v[4]), wide(v[5])}};
}

}  // namespace

bool PoseReceiver::accept(std::span<const std::uint8_t> datagram, const Endpoint& from, Time now) {
  ++counters_.datagrams;
  const auto refuse = [&](std::uint64_t& reason) {
    ++reason;
    ++counters_.rejected;
    return false;
  };
  if (!from.same_address(accept_from_)) return refuse(counters_.foreign_address);
  protocol::Opened opened;
  protocol::PoseInputMessage message;
  const Reject reason = judge(datagram, opened, message);
  if (reason != Reject::none) return refuse(counters_.rejected_by[static_cast<std::size_t>(reason)]);
  if (message.time > now + kClockTolerance) return refuse(counters_.in_future);
  const bool restarted = boot_id_ != opened.header.boot_id;
  const auto newest = restarted ? std::nullopt : history_.newest();
  if (newest && message.time <= newest->time) return refuse(counters_.not_later);
  // All of it was judged: a refused datagram leaves neither its boot_id nor its seq behind.
  if (restarted) begin_history(opened.header.boot_id);
  seq_ = opened.header.seq;
  history_.add({message.time, message.T_map_body}, variance_of(message));
  ++counters_.accepted;
  return true;
}

Reject PoseReceiver::judge(std::span<const std::uint8_t> datagram, protocol::Opened& opened,
                           protocol::PoseInputMessage& message) const {
  if (const Reject reason = protocol::open_datagram(datagram, opened, keys_); reason != Reject::none) return reason;
  if (opened.header.stream_id != stream_id_) return Reject::stream;
  if (opened.header.type != protocol::MessageType::pose_input) return Reject::type;
  if (const Reject reason = decode(opened, message); reason != Reject::none) return reason;
  return check_sequence(opened.header);
}

Reject PoseReceiver::check_sequence(const protocol::Header& header) const {
  if (boot_id_ == header.boot_id)  // a late pose is of no use: the history only grows at its end
    return header.seq <= seq_ ? Reject::sequence : Reject::none;
  const auto known = std::min(boots_, old_boots_.size());
  const auto end = old_boots_.begin() + static_cast<std::ptrdiff_t>(known);
  return std::find(old_boots_.begin(), end, header.boot_id) != end ? Reject::old_boot : Reject::none;
}

void PoseReceiver::begin_history(std::uint64_t boot_id) {
  if (boot_id_) old_boots_[boots_++ % old_boots_.size()] = *boot_id_;
  boot_id_ = boot_id;
  history_.clear();  // a restarted source may have another map frame
}

Result<std::unique_ptr<PoseInput>> PoseInput::open(const std::string& listen, const std::string& accept_from,
                                                   std::uint32_t stream_id) {
  const auto local = parse_endpoint(listen, "publish.listen");
  if (!local) return local.error();
  if (local->any_address())
    return Error{ErrorKind::usage,
                 "publish.listen: expected one address of this machine, found '" + listen + "', which is all of them"};
  const auto from =
      parse_address(accept_from.empty() ? (local->v6 ? "::1" : "127.0.0.1") : accept_from, "pose.accept_from");
  if (!from) return from.error();
  auto socket = UdpSocket::bind(*local, "publish.listen");
  if (!socket) return socket.error();
  return std::unique_ptr<PoseInput>(new PoseInput(std::move(*socket), PoseReceiver(*from, stream_id)));
}

Result<bool> PoseInput::poll(std::chrono::milliseconds timeout) {
  bool taken = false;
  const auto count = socket_.receive(timeout, [&](std::span<const std::uint8_t> datagram, const Endpoint& from) {
    const Time now = std::chrono::time_point_cast<Duration>(std::chrono::system_clock::now());
    taken = receiver_.accept(datagram, from, now) || taken;
  });
  if (!count) return count.error();
  return taken;
}

}  // namespace scree::node
