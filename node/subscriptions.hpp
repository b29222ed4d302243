#pragma once
// Who gets the map because they asked for it: cookies, leases, and what each request leads to. No sockets, no clock of
// its own.

#include <cstdint>
#include <optional>
#include <vector>

#include "node/cookie.hpp"
#include "node/protocol.hpp"
#include "node/publisher_pacing.hpp"
#include "node/requests.hpp"

namespace scree::node {

inline constexpr Duration kLease = std::chrono::seconds(3);

struct SubscriptionCounters {
  std::uint64_t subscribes = 0;          ///< SUBSCRIBE that came
  std::uint64_t cookies = 0;             ///< COOKIE sent
  std::uint64_t cookie_unknown = 0;      ///< SUBSCRIBE and NACK with a cookie that is not, or no longer, good
  std::uint64_t begun = 0;               ///< subscriptions
  std::uint64_t ended = 0;               ///< by the client
  std::uint64_t lease_expired = 0;       ///< by its silence
  std::uint64_t refused_full = 0;        ///< SUBSCRIBE for which there was no room
  std::uint64_t outdated = 0;            ///< duplicates, and SUBSCRIBE older than the newest one of that client
  std::uint64_t nacks = 0;               ///< NACK of subscribers
  std::uint64_t nacks_unsubscribed = 0;  ///< NACK of others
  std::uint64_t nack_tiles = 0;          ///< tiles that they named
  std::uint64_t tiles_requeued = 0;      ///< of these, sent again because of it
  std::uint64_t pings = 0;
  std::uint64_t rate_limited = 0;  ///< requests that came faster than they are answered
};

/// What one request leads to. `slot` is the subscriber's.
struct RequestOutcome {
  enum class What : std::uint8_t { nothing, send_cookie, send_pong, begin, change, end, resend };
  What what = What::nothing;
  std::size_t slot = 0;
  std::uint64_t cookie = 0;    ///< to be sent, besides `begin` and `change` where the client's is aging; 0 = none
  bool restarted = false;      ///< of `change`: the client started again and holds nothing
  bool first_refusal = false;  ///< for want of room, for the first time
};

class Subscriptions {
 public:
  /// `fixed`: the destination that is sent to anyhow; it has slot 0 and may subscribe to be heard, whatever the limit.
  Subscriptions(std::size_t limit, const CookieJar& cookies, std::optional<Endpoint> fixed = std::nullopt);

  /// Slots are below limit + 1.
  RequestOutcome take(const Request& request, MonotonicTime now);
  /// A slot whose lease is over; it is free from then on. None: no (more) such slot.
  std::optional<std::size_t> expire(MonotonicTime now);
  /// The next lease to end.
  std::optional<MonotonicTime> next_expiry() const;

  /// What the subscriber in an active slot asked for last.
  const protocol::Subscribe& wish(std::size_t slot) const { return slots_[slot].wish; }
  const Endpoint& endpoint(std::size_t slot) const { return slots_[slot].endpoint; }
  std::size_t slots() const { return slots_.size(); }
  /// Without the fixed destination.
  std::size_t active() const;

  SubscriptionCounters counters;

 private:
  struct Slot {
    bool active = false;
    Endpoint endpoint;
    std::uint64_t boot_id = 0;
    std::uint64_t subscribe_seq = 0;
    protocol::SequenceWindow sequence;
    MonotonicTime lease_end;
    protocol::Subscribe wish;
    TokenBucket nacks{kNacksPerSecond, kNacksPerSecond};
  };
  /// A map of 65 × 65 tiles and six layers is 198 NACKs.
  static constexpr double kNacksPerSecond = 200.0;
  /// Answers to addresses that proved nothing: together at most this many, for their sum is what could be reflected.
  static constexpr double kAnswersPerSecond = 1000.0;

  RequestOutcome subscribe(const Request& request, const protocol::Subscribe& wish, MonotonicTime now);
  RequestOutcome nack(const Request& request, const protocol::Nack& message, MonotonicTime now);
  RequestOutcome answer(RequestOutcome::What what, const Endpoint& to, MonotonicTime now);
  std::optional<std::size_t> find(const Endpoint& endpoint) const;
  std::optional<std::size_t> room_for(const Endpoint& endpoint) const;
  bool fresh(Slot& slot, const Request& request);

  CookieJar cookies_;
  std::optional<Endpoint> fixed_;
  std::vector<Slot> slots_;
  TokenBucket answers_{kAnswersPerSecond};
};

}  // namespace scree::node
