#include "node/requests.hpp"

namespace scree::node {

using protocol::MessageType;
using protocol::Reject;

Reject RequestReader::read(std::span<const std::uint8_t> datagram, const Endpoint& from, Request& out) {
  out.from = from;
  const Reject reason = judge(datagram, out);
  ++counters_.datagrams;
  ++counters_.rejected_by[static_cast<std::size_t>(reason)];
  ++(reason == Reject::none ? counters_.accepted : counters_.rejected);
  return reason;
}

Reject RequestReader::judge(std::span<const std::uint8_t> datagram, Request& out) const {
  protocol::Opened opened;
  if (const Reject reason = protocol::open_datagram(datagram, opened, keys_); reason != Reject::none) return reason;
  if (opened.header.stream_id != stream_id_) return Reject::stream;
  out.boot_id = opened.header.boot_id;
  out.seq = opened.header.seq;
  switch (opened.header.type) {
    case MessageType::subscribe:
      return decode(opened, out.message.emplace<protocol::Subscribe>());
    case MessageType::nack:
      return decode(opened, out.message.emplace<protocol::Nack>());
    case MessageType::ping:
      return decode(opened, out.message.emplace<protocol::Ping>());
    default:
      return Reject::type;
  }
}

void RequestQueue::push(const Request& request) {
  const std::lock_guard lock(mutex_);
  if (size_ == kCapacity) {
    ++overflowed_;
    return;
  }
  ring_[(first_ + size_++) % kCapacity] = request;
}

bool RequestQueue::pop(Request& out) {
  const std::lock_guard lock(mutex_);
  if (size_ == 0) return false;
  out = ring_[first_];
  first_ = (first_ + 1) % kCapacity;
  --size_;
  return true;
}

bool RequestQueue::empty() const {
  const std::lock_guard lock(mutex_);
  return size_ == 0;
}

std::uint64_t RequestQueue::overflowed() const {
  const std::lock_guard lock(mutex_);
  return overflowed_;
}

}  // namespace scree::node
