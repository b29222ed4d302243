#include "node/subscriptions.hpp"

#include <algorithm>

namespace scree::node {

using What = RequestOutcome::What;

Subscriptions::Subscriptions(std::size_t limit, const CookieJar& cookies, std::optional<Endpoint> fixed)
    : cookies_(cookies), fixed_(fixed), slots_(limit + 1) {}

RequestOutcome Subscriptions::take(const Request& request, MonotonicTime now) {
  if (const auto* wish = std::get_if<protocol::Subscribe>(&request.message)) return subscribe(request, *wish, now);
  if (const auto* message = std::get_if<protocol::Nack>(&request.message)) return nack(request, *message, now);
  ++counters.pings;
  return answer(What::send_pong, request.from, now);
}

RequestOutcome Subscriptions::answer(What what, const Endpoint& to, MonotonicTime now) {
  answers_.refill(now);
  if (!answers_.has_token()) {
    ++counters.rate_limited;
    return {};
  }
  answers_.take(1);
  RequestOutcome outcome;
  outcome.what = what;
  if (what == What::send_cookie) {
    ++counters.cookies;
    outcome.cookie = cookies_.cookie(to, now);
  }
  return outcome;
}

/// The slot's client with a datagram that is not one of before. A client that started again begins anew.
bool Subscriptions::fresh(Slot& slot, const Request& request) {
  if (slot.boot_id != request.boot_id) {
    slot.boot_id = request.boot_id;
    slot.sequence = {};
    slot.subscribe_seq = 0;
  }
  if (slot.sequence.note(request.seq) == protocol::SequenceWindow::Verdict::fresh) return true;
  ++counters.outdated;
  return false;
}

RequestOutcome Subscriptions::subscribe(const Request& request, const protocol::Subscribe& wish, MonotonicTime now) {
  ++counters.subscribes;
  const CookieJar::Verdict verdict = cookies_.check(wish.cookie, request.from, now);
  if (verdict == CookieJar::Verdict::bad) {
    if (wish.cookie != 0) ++counters.cookie_unknown;
    return answer(What::send_cookie, request.from, now);
  }
  const auto held = find(request.from);
  if (wish.layer_mask == 0 && !held) return {};
  const auto place = held ? held : room_for(request.from);
  RequestOutcome outcome;
  if (!place) {
    outcome.first_refusal = counters.refused_full++ == 0;
    return outcome;
  }
  outcome.slot = *place;
  Slot& slot = slots_[*place];
  if (!held) slot = {};
  slot.endpoint = request.from;
  outcome.restarted = held && slot.boot_id != request.boot_id;
  if (!fresh(slot, request)) return {};
  if (request.seq < slot.subscribe_seq) {
    ++counters.outdated;
    return {};
  }
  slot.subscribe_seq = request.seq;
  if (wish.layer_mask == 0) {
    slot.active = false;
    ++counters.ended;
    outcome.what = What::end;
    return outcome;
  }
  slot.active = true;
  slot.lease_end = now + kLease;
  slot.wish = wish;
  counters.begun += held ? 0 : 1;
  outcome.what = held ? What::change : What::begin;
  if (verdict == CookieJar::Verdict::aging) {
    ++counters.cookies;
    outcome.cookie = cookies_.cookie(request.from, now);
  }
  return outcome;
}

RequestOutcome Subscriptions::nack(const Request& request, const protocol::Nack& message, MonotonicTime now) {
  const auto held = find(request.from);
  if (!held) {
    ++counters.nacks_unsubscribed;
    return {};
  }
  if (cookies_.check(message.cookie, request.from, now) == CookieJar::Verdict::bad) {
    ++counters.cookie_unknown;
    return {};
  }
  Slot& slot = slots_[*held];
  if (!fresh(slot, request)) return {};
  slot.lease_end = now + kLease;  // whoever misses something is there: on a bad way it renews more often than SUBSCRIBE
  slot.nacks.refill(now);
  if (!slot.nacks.has_token()) {
    ++counters.rate_limited;
    return {};
  }
  slot.nacks.take(1);
  ++counters.nacks;
  counters.nack_tiles += message.count;
  RequestOutcome outcome;
  outcome.what = What::resend;
  outcome.slot = *held;
  return outcome;
}

std::optional<std::size_t> Subscriptions::find(const Endpoint& endpoint) const {
  const auto at = std::find_if(slots_.begin(), slots_.end(),
                               [&](const Slot& slot) { return slot.active && slot.endpoint == endpoint; });
  if (at == slots_.end()) return std::nullopt;
  return static_cast<std::size_t>(at - slots_.begin());
}

std::optional<std::size_t> Subscriptions::room_for(const Endpoint& endpoint) const {
  if (fixed_ == endpoint) return 0;
  const auto at = std::find_if(slots_.begin() + 1, slots_.end(), [](const Slot& slot) { return !slot.active; });
  if (at == slots_.end()) return std::nullopt;
  return static_cast<std::size_t>(at - slots_.begin());
}

std::optional<std::size_t> Subscriptions::expire(MonotonicTime now) {
  for (std::size_t i = 0; i < slots_.size(); ++i) {
    if (!slots_[i].active || now < slots_[i].lease_end) continue;
    slots_[i].active = false;
    ++counters.lease_expired;
    return i;
  }
  return std::nullopt;
}

std::optional<MonotonicTime> Subscriptions::next_expiry() const {
  std::optional<MonotonicTime> next;
  for (const Slot& slot : slots_)
    if (slot.active && (!next || slot.lease_end < *next)) next = slot.lease_end;
  return next;
}

std::size_t Subscriptions::active() const {
  return static_cast<std::size_t>(
      std::count_if(slots_.begin() + 1, slots_.end(), [](const Slot& slot) { return slot.active; }));
}

}  // namespace scree::node
