#include "node/listener_assembly.hpp"

#include <algorithm>

namespace scree::node {
namespace {

using protocol::MessageType;
using protocol::Reject;

constexpr Duration kStale = std::chrono::milliseconds(300);
constexpr Duration kLost = std::chrono::milliseconds(1000);
constexpr Duration kBootReorder = std::chrono::seconds(1);

/// What the sender announces may shorten a limit, never lengthen it.
Duration shorter(Duration limit, std::uint32_t announced_ms) {
  return std::min<Duration>(limit, std::chrono::milliseconds(announced_ms));
}

template <class Message>
Reject check(const protocol::Opened& opened) {
  Message message;
  return decode(opened, message);
}

/// Everything is forgotten for a new boot_id, so its first datagram must be good throughout.
Reject check_body(const protocol::Opened& opened) {
  switch (opened.header.type) {
    case MessageType::announce:
      return check<protocol::Announce>(opened);
    case MessageType::tile:
      return check<protocol::TileBlock>(opened);
    case MessageType::manifest:
      return check<protocol::Manifest>(opened);
    case MessageType::heartbeat:
      return check<protocol::Heartbeat>(opened);
    case MessageType::bye:
      return check<protocol::Bye>(opened);
    case MessageType::pose:
      return check<protocol::PoseMessage>(opened);
    case MessageType::cookie:
      return check<protocol::Cookie>(opened);
    case MessageType::pong:
      return check<protocol::Pong>(opened);
    default:
      return Reject::type;
  }
}

/// COOKIE and PONG of a node that sends us no map.
bool outside_of_streams(const protocol::Header& header) {
  return header.seq == 0 && (header.type == MessageType::cookie || header.type == MessageType::pong);
}

}  // namespace

Reject MapAssembly::accept(std::span<const std::uint8_t> datagram, MonotonicTime now) {
  advance(now);
  const Reject reason = judge(datagram, now);
  count(reason);
  advance(now);
  return reason;
}

void MapAssembly::count(Reject reason) {
  ++counters_.datagrams;
  ++counters_.rejected_by[static_cast<std::size_t>(reason)];
  switch (reason) {
    case Reject::none:
      ++counters_.accepted;
      break;
    case Reject::origin:
      ++counters_.refused_origin;
      break;
    case Reject::type:
    case Reject::layer:
      ++counters_.ignored;
      break;
    default:
      ++counters_.rejected;
  }
  counters_.lost = lost_before_ + sequence_.lost();
}

Reject MapAssembly::judge(std::span<const std::uint8_t> datagram, MonotonicTime now) {
  protocol::Opened opened;
  if (const Reject reason = protocol::open_datagram(datagram, opened, keys_); reason != Reject::none) return reason;
  if (const Reject reason = check_sender(opened, now); reason != Reject::none) return reason;
  const Reject reason = take(opened, now);
  if (reason == Reject::none) stream_id_ = opened.header.stream_id;
  return reason;
}

Reject MapAssembly::check_sender(const protocol::Opened& opened, MonotonicTime now) {
  const protocol::Header& header = opened.header;
  if (stream_id_ && header.stream_id != *stream_id_) return Reject::stream;
  if (!accept_.contains(header.origin)) {
    refused_origin_ = header.origin;
    return Reject::origin;
  }
  if (boot_id_ != header.boot_id) {
    const auto known = std::min(boots_, old_boots_.size());
    for (std::size_t i = 0; i < known; ++i) {
      if (old_boots_[i].boot_id != header.boot_id) continue;
      if (now - old_boots_[i].replaced > kBootReorder) conflict_at_ = now;  // two senders on one stream
      return Reject::old_boot;
    }
    if (const Reject reason = check_body(opened); reason != Reject::none) return reason;
    begin_boot(header.boot_id, now);
  }
  if (outside_of_streams(header)) return Reject::none;
  return sequence_.note(header.seq) == protocol::SequenceWindow::Verdict::fresh ? Reject::none : Reject::sequence;
}

void MapAssembly::begin_boot(std::uint64_t boot_id, MonotonicTime now) {
  if (boot_id_) {
    if (valid()) last_valid_ = make_map(now, true);
    old_boots_[boots_++ % old_boots_.size()] = {*boot_id_, now};
    link_ = LinkState::lost;
  }
  lost_before_ += sequence_.lost();
  boot_id_ = boot_id;
  sequence_ = {};
  announce_.reset();
  announce_seq_ = 0;
  heartbeat_.reset();
  heartbeat_seq_ = 0;
  bye_.reset();
  cookie_.reset();
  pong_.reset();
  pose_.reset();
  pose_seq_ = 0;
  newest_ = {};
  tiles_.clear();
}

Reject MapAssembly::take(const protocol::Opened& opened, MonotonicTime now) {
  Reject reason = Reject::type;
  switch (opened.header.type) {
    case MessageType::announce:
      reason = take_announce(opened);
      break;
    case MessageType::tile:
      reason = take_tile(opened, now);
      break;
    case MessageType::manifest:
      reason = take_manifest(opened, now);
      break;
    case MessageType::heartbeat:
      reason = take_heartbeat(opened, now);
      break;
    case MessageType::bye:
      reason = take_bye(opened);
      break;
    case MessageType::pose:
      reason = take_pose(opened);
      break;
    case MessageType::cookie:
      reason = take_cookie(opened);
      break;
    case MessageType::pong:
      reason = take_pong(opened, now);
      break;
    default:
      break;
  }
  if (reason == Reject::none) take_header(opened.header, now);
  return reason;
}

void MapAssembly::take_header(const protocol::Header& header, MonotonicTime now) {
  origin_ = header.origin;
  if (header.seq < newest_.seq) return;
  newest_ = header;
  acquired_ = now - std::chrono::microseconds(header.age_us);
}

Reject MapAssembly::take_announce(const protocol::Opened& opened) {
  protocol::Announce message;
  if (const Reject reason = decode(opened, message); reason != Reject::none) return reason;
  if (announce_ && opened.header.seq < announce_seq_) return Reject::none;  // a late one tells nothing new
  if (announce_ && (announce_->map_id != message.map_id || announce_->resolution_m != message.resolution_m))
    tiles_.clear();
  tiles_.set_window(message.window);
  announce_ = std::move(message);
  announce_seq_ = opened.header.seq;
  return Reject::none;
}

Reject MapAssembly::take_tile(const protocol::Opened& opened, MonotonicTime now) {
  if (const Reject reason = decode(opened, block_); reason != Reject::none) return reason;
  switch (tiles_.put(block_, now)) {
    case TileStore::Taken::yes:
      ++counters_.tiles;
      break;
    case TileStore::Taken::no_window:
      ++counters_.tiles_without_window;
      break;
    case TileStore::Taken::outside:
      ++counters_.tiles_outside;
      break;
    case TileStore::Taken::outdated:
      ++counters_.tiles_outdated;
      break;
  }
  return Reject::none;
}

Reject MapAssembly::take_manifest(const protocol::Opened& opened, MonotonicTime now) {
  protocol::Manifest message;
  if (const Reject reason = decode(opened, message); reason != Reject::none) return reason;
  tiles_.note(message, now);
  return Reject::none;
}

Reject MapAssembly::take_heartbeat(const protocol::Opened& opened, MonotonicTime now) {
  protocol::Heartbeat message;
  if (const Reject reason = decode(opened, message); reason != Reject::none) return reason;
  heartbeat_at_ = now;
  if (heartbeat_ && opened.header.seq < heartbeat_seq_) return Reject::none;
  heartbeat_ = message;
  heartbeat_seq_ = opened.header.seq;
  return Reject::none;
}

Reject MapAssembly::take_bye(const protocol::Opened& opened) {
  protocol::Bye message;
  if (const Reject reason = decode(opened, message); reason != Reject::none) return reason;
  bye_ = message.reason;
  return Reject::none;
}

Reject MapAssembly::take_pose(const protocol::Opened& opened) {
  protocol::PoseMessage message;
  if (const Reject reason = decode(opened, message); reason != Reject::none) return reason;
  if (pose_ && opened.header.seq < pose_seq_) return Reject::none;
  pose_ = message;
  pose_seq_ = opened.header.seq;
  return Reject::none;
}

Reject MapAssembly::take_cookie(const protocol::Opened& opened) {
  protocol::Cookie message;
  if (const Reject reason = decode(opened, message); reason != Reject::none) return reason;
  cookie_ = message.cookie;
  return Reject::none;
}

Reject MapAssembly::take_pong(const protocol::Opened& opened, MonotonicTime now) {
  protocol::Pong message;
  if (const Reject reason = decode(opened, message); reason != Reject::none) return reason;
  pong_ = {message, now};
  return Reject::none;
}

LinkState MapAssembly::link_at(MonotonicTime now) const {
  if (!boot_id_) return LinkState::waiting;
  if (bye_ || (newest_.health & protocol::kHealthFault)) return LinkState::lost;
  if (conflict_at_ && now - *conflict_at_ < kLost) return LinkState::lost;
  if (!heartbeat_) return link_ == LinkState::waiting ? LinkState::waiting : LinkState::lost;
  const Duration silence = now - heartbeat_at_;
  if (silence >= (announce_ ? shorter(kLost, announce_->lost_ms) : kLost)) return LinkState::lost;
  if (silence >= (announce_ ? shorter(kStale, announce_->stale_ms) : kStale)) return LinkState::stale;
  return LinkState::fresh;
}

void MapAssembly::advance(MonotonicTime now) {
  const LinkState next = link_at(now);
  if (next == LinkState::lost && valid()) {
    // a silence is noticed late: what was valid then, not what has expired since
    last_valid_ = make_map(std::min(now, heartbeat_at_ + kLost), true);
  }
  // also of a node that was at fault before it fell silent: what it sent then must not come back
  const bool silent =
      heartbeat_ && !bye_ && now - heartbeat_at_ >= (announce_ ? shorter(kLost, announce_->lost_ms) : kLost);
  if (silent && !silent_) tiles_.forget_tiles();
  silent_ = silent;
  link_ = next;
}

std::uint16_t MapAssembly::health() const {
  const bool conflict = conflict_at_ && link_ == LinkState::lost;
  return static_cast<std::uint16_t>(newest_.health | (conflict ? protocol::kHealthFault : 0));
}

std::shared_ptr<const mapping::MapSnapshot> MapAssembly::make_map(MonotonicTime now, bool valid) const {
  if (!announce_) return nullptr;
  auto map = tiles_.map(now, std::chrono::milliseconds(announce_->cell_max_age_ms), valid);
  map->cell_m = announce_->resolution_m;
  map->revision = newest_.map_rev;
  map->data_time = Time(Duration(newest_.t_data_ns));
  map->received = acquired_;
  return map;
}

std::shared_ptr<const mapping::MapSnapshot> MapAssembly::map(MonotonicTime now) const {
  return make_map(now, valid());
}

std::shared_ptr<const mapping::MapSnapshot> MapAssembly::last_valid_map(MonotonicTime now) const {
  return valid() && announce_ ? make_map(now, true) : last_valid_;
}

}  // namespace scree::node
