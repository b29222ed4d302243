// What clients ask of the sender.

#include "tests/support/map_sender.hpp"

namespace scree::test {
namespace {

using namespace node::protocol;

constexpr std::uint64_t kCookie = 0xC00C1E;
constexpr Nanoseconds kLease = std::chrono::seconds(3);

}  // namespace

void MapSender::receive(std::span<const std::uint8_t> datagram, Nanoseconds now, const Send& send) {
  Opened opened;
  if (open_datagram(datagram, opened, keys_) != Reject::none) return;
  Subscribe subscribe;
  Nack nack;
  Ping ping;
  switch (opened.header.type) {
    case MessageType::subscribe:
      if (decode(opened, subscribe) != Reject::none) return;
      if (subscribe.cookie != kCookie) return emit(Cookie{kCookie, 3000}, now, send);
      if (now >= lease_end_) next_announce_ = next_manifest_ = now;
      lease_end_ = subscribe.layer_mask == 0 ? now : now + kLease;
      repeats_ = subscribe.repeats;
      return;
    case MessageType::nack:
      if (decode(opened, nack) != Reject::none || nack.cookie != kCookie || now >= lease_end_) return;
      ++nacks_;
      lease_end_ = now + kLease;
      for (std::size_t layer = 0; layer < settings_.layers.size(); ++layer) {
        for (std::size_t i = 0; settings_.layers[layer] == nack.layer && i < nack.count; ++i) {
          if (!tiles_.contains(nack.tiles[i])) continue;
          const std::size_t unit = layer * history_.size() + tiles_.position(nack.tiles[i]);
          if (!units_[unit].pending && !units_[unit].nacked) nacked_.push_back(unit);
          units_[unit].nacked = true;
        }
      }
      return;
    case MessageType::ping:
      if (decode(opened, ping) == Reject::none) emit(Pong{ping.nonce, ping.t_request_ns, 5, 6}, now, send);
      return;
    default:
      return;
  }
}

}  // namespace scree::test
