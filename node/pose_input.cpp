#include "node/pose_input.hpp"

#include <algorithm>

namespace scree::node {
namespace {

using protocol::Reject;

constexpr Duration kClockTolerance = std::chrono::seconds(1);
constexpr Duration kPastTolerance = std::chrono::seconds(10);

PoseVariance variance_of(const protocol::PoseInputMessage& message) {
  const auto& v = message.variances;
  const auto wide = [](float x) { return static_cast<double>(x); };
  return {{wide(v[0]), wide(v[1]), wide(v[2])}, {wide(v[3]), wide(v[4]), wide(v[5])}};
}

}  // namespace

bool PoseReceiver::accept(std::span<const std::uint8_t> datagram, const Endpoint& from, Time now,
                          MonotonicTime delivered) {
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
  if (message.time < now - kPastTolerance) return refuse(counters_.in_past);
  if (newest_ && message.time <= *newest_) return refuse(counters_.not_later);
  // All of it was judged: a refused datagram leaves neither its boot_id nor its seq behind.
  if (restarted) begin_history(opened.header.boot_id);
  seq_ = opened.header.seq;
  history_.add({message.time, message.T_map_body}, variance_of(message), delivered);
  newest_ = message.time;
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

bool PoseInput::accept(std::span<const std::uint8_t> datagram, const Endpoint& from, Time now,
                       MonotonicTime delivered) {
  const std::lock_guard lock(mutex_);
  const bool taken = receiver_.accept(datagram, from, now, delivered);
  if (taken) changed_.notify_all();
  return taken;
}

std::optional<UncertainPose> PoseInput::at(Time time) const {
  const std::lock_guard lock(mutex_);
  return receiver_.history().at(time);
}

std::optional<UncertainPose> PoseInput::newest() const {
  const std::lock_guard lock(mutex_);
  return receiver_.history().newest();
}

bool PoseInput::wait_for(Time time, std::chrono::milliseconds timeout, const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  return changed_.wait_for(lock, stop, timeout, [&] {
    const auto newest = receiver_.history().newest();
    return newest && newest->time >= time;
  });
}

PoseInputCounters PoseInput::counters() const {
  const std::lock_guard lock(mutex_);
  return receiver_.counters();
}

}  // namespace scree::node
