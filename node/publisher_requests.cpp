// What the publisher does when clients ask.

#include <algorithm>
#include <array>
#include <spdlog/spdlog.h>

#include "node/publisher_state.hpp"

namespace scree::node {
namespace {

std::int64_t unix_ns(Time time) {
  return time.time_since_epoch().count();
}

}  // namespace

template <class Message>
void Publisher::State::answer(const Endpoint& to, const Message& message, MonotonicTime now) {
  for (std::size_t slot = 1; slot < streams.size(); ++slot)
    if (streams[slot] && subscriptions.endpoint(slot) == to) {
      streams[slot]->answer(message, now, map);  // without room it is lost, as UDP may lose it
      return;
    }
  protocol::Datagram datagram;
  protocol::Header header = map.header(now);  // seq 0: not of a stream
  protocol::encode(header, message, datagram, map.keys.signer());
  const auto view = datagram.view();
  const auto sent = clients->send(std::span(&view, 1), &to);
  map.counters.datagrams += sent.datagrams;
  map.counters.bytes += sent.datagrams * view.size();
  if (sent.outcome == UdpSocket::Outcome::blocked)
    ++map.counters.send_blocked;
  else if (sent.outcome != UdpSocket::Outcome::all)
    ++map.counters.send_errors;
}

StreamWish Publisher::State::wish_of(const protocol::Subscribe& subscribe) const {
  const double own = map.settings.datagrams_per_s;
  const double asked = subscribe.datagrams_per_s;
  return {subscribe.layer_mask, subscribe.region, asked > 0 ? std::min(asked, own) : own, subscribe.repeats};
}

void Publisher::State::begin_stream(std::size_t slot) {
  if (slot == 0) return change_stream(slot);
  streams[slot].emplace(clients, subscriptions.endpoint(slot), wish_of(subscriptions.wish(slot)), first_seq, map);
}

/// The configured destination gets everything whatever it asks for, but with the repeats that it asks for.
void Publisher::State::change_stream(std::size_t slot) {
  StreamWish wish = wish_of(subscriptions.wish(slot));
  if (slot == 0) {
    wish = {};
    wish.datagrams_per_s = map.settings.datagrams_per_s;
    wish.repeats = subscriptions.wish(slot).repeats;
  }
  streams[slot]->change(wish, map);
}

void Publisher::State::end_stream(std::size_t slot) {
  if (slot == 0) {
    StreamWish everything;
    everything.datagrams_per_s = map.settings.datagrams_per_s;
    return fixed().change(everything, map);
  }
  first_seq = std::max(first_seq, streams[slot]->outbox().next_seq());
  streams[slot].reset();
}

void Publisher::State::resend(std::size_t slot, const protocol::Nack& nack) {
  for (std::size_t i = 0; i < nack.count; ++i) {
    const auto unit = map.book.find(nack.tiles[i], nack.layer);
    if (unit && streams[slot]->resend(*unit, map)) ++subscriptions.counters.tiles_requeued;
  }
}

void Publisher::State::expire_leases(MonotonicTime now) {
  while (const auto slot = subscriptions.expire(now)) {
    spdlog::info("{} no longer subscribes: its lease of {} s is over", to_string(subscriptions.endpoint(*slot)),
                 to_seconds(kLease));
    end_stream(*slot);
  }
}

void Publisher::handle(const Request& request, MonotonicTime now) {
  State& s = *state_;
  if (s.clients == nullptr) return;
  s.expire_leases(now);
  const RequestOutcome outcome = s.subscriptions.take(request, now);
  using What = RequestOutcome::What;
  switch (outcome.what) {
    case What::begin:
      spdlog::info("{} subscribes", to_string(request.from));
      s.begin_stream(outcome.slot);
      break;
    case What::change:
      s.change_stream(outcome.slot);
      if (outcome.restarted) s.streams[outcome.slot]->send_all_again(s.map);
      break;
    case What::end:
      spdlog::info("{} no longer subscribes", to_string(request.from));
      s.end_stream(outcome.slot);
      break;
    case What::resend:
      s.resend(outcome.slot, std::get<protocol::Nack>(request.message));
      break;
    case What::send_pong: {
      const auto& ping = std::get<protocol::Ping>(request.message);
      const Time leaves = std::chrono::time_point_cast<Duration>(std::chrono::system_clock::now());
      s.answer(request.from,
               protocol::Pong{ping.nonce, ping.t_request_ns, unix_ns(request.arrived_at), unix_ns(leaves)}, now);
      break;
    }
    case What::send_cookie:
    case What::nothing:
      break;
  }
  if (outcome.cookie != 0)
    s.answer(request.from,
             protocol::Cookie{outcome.cookie, static_cast<std::uint32_t>(kLease / std::chrono::milliseconds(1))}, now);
  if (outcome.first_refusal)
    spdlog::warn("{} may not subscribe: {} others do (publish.max_subscribers); further refusals are only counted",
                 to_string(request.from), s.subscriptions.active());
}

}  // namespace scree::node
