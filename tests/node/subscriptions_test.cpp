// Cookies, leases and limits, on a clock of the test's own and without sockets.

#include "node/subscriptions.hpp"

#include <gtest/gtest.h>

namespace scree::node {
namespace {

using namespace std::chrono_literals;
using What = RequestOutcome::What;

const Endpoint kFixed = *parse_endpoint("127.0.0.1:47800", "test");

struct Desk {
  CookieJar jar{{1, 2, 3}};
  Subscriptions subscriptions{2, jar, kFixed};
  MonotonicTime now = MonotonicTime{} + 1000s;
  std::uint64_t seq = 0;

  static Endpoint client(int port) { return *parse_endpoint("127.0.0.1:" + std::to_string(port), "test"); }
  Request request(const Endpoint& from, std::uint64_t boot = 5) {
    Request out;
    out.from = from;
    out.boot_id = boot;
    out.seq = ++seq;
    return out;
  }
  RequestOutcome subscribe(const Endpoint& from, std::uint64_t cookie, std::uint64_t layers = 1) {
    Request out = request(from);
    out.message = protocol::Subscribe{cookie, layers, {}, 0, 0};
    return subscriptions.take(out, now);
  }
  RequestOutcome nack(const Endpoint& from, std::uint64_t cookie) {
    Request out = request(from);
    protocol::Nack message;
    message.cookie = cookie;
    message.count = 3;
    out.message = message;
    return subscriptions.take(out, now);
  }
};

TEST(Cookie, IsOfOneAddressAndPortAndGoodFor60To120Seconds) {
  const CookieJar jar({7});
  const Endpoint client = Desk::client(5000);
  for (const Duration into_slot : {Duration(0s), Duration(30s), Duration(60s - 1ns)}) {
    const MonotonicTime given = MonotonicTime{} + 1200s + into_slot;
    const std::uint64_t cookie = jar.cookie(client, given);
    EXPECT_NE(cookie, 0u);
    EXPECT_EQ(jar.check(cookie, client, given), CookieJar::Verdict::good);
    EXPECT_NE(jar.check(cookie, client, given + 60s), CookieJar::Verdict::bad);
    EXPECT_EQ(jar.check(cookie, client, given + 120s), CookieJar::Verdict::bad);
    EXPECT_EQ(jar.check(cookie, Desk::client(5001), given), CookieJar::Verdict::bad);
    EXPECT_EQ(jar.check(cookie, *parse_endpoint("127.0.0.2:5000", "test"), given), CookieJar::Verdict::bad);
    EXPECT_EQ(jar.check(0, client, given), CookieJar::Verdict::bad);
    EXPECT_EQ(CookieJar({8}).check(cookie, client, given), CookieJar::Verdict::bad);
  }
}

TEST(Cookie, TwoJarsHaveTwoKeys) {
  const auto one = CookieJar::open(), two = CookieJar::open();
  ASSERT_TRUE(one && two);
  EXPECT_NE(one->cookie(Desk::client(1), {}), two->cookie(Desk::client(1), {}));
}

TEST(Subscriptions, BeginWithTheCookieAndEndAfterThreeSecondsOfSilence) {
  Desk desk;
  const Endpoint client = Desk::client(5000);
  const auto first = desk.subscribe(client, 0);
  ASSERT_EQ(first.what, What::send_cookie);
  EXPECT_EQ(desk.subscriptions.active(), 0u);
  const auto begun = desk.subscribe(client, first.cookie, 0x3);
  ASSERT_EQ(begun.what, What::begin);
  EXPECT_EQ(begun.cookie, 0u);
  EXPECT_EQ(desk.subscriptions.wish(begun.slot).layer_mask, 3u);
  desk.now += 2900ms;
  EXPECT_FALSE(desk.subscriptions.expire(desk.now));
  EXPECT_EQ(desk.subscribe(client, first.cookie, 0x5).what, What::change);
  EXPECT_EQ(desk.subscriptions.wish(begun.slot).layer_mask, 5u);
  EXPECT_EQ(desk.subscriptions.next_expiry(), desk.now + 3s);
  desk.now += 3s - 1ns;
  EXPECT_FALSE(desk.subscriptions.expire(desk.now));
  desk.now += 1ns;
  EXPECT_EQ(desk.subscriptions.expire(desk.now), begun.slot);
  EXPECT_FALSE(desk.subscriptions.expire(desk.now));
  EXPECT_EQ(desk.subscriptions.counters.lease_expired, 1u);
  EXPECT_EQ(desk.subscribe(client, first.cookie).what, What::begin);
  EXPECT_EQ(desk.subscribe(client, first.cookie, 0).what, What::end);
  EXPECT_EQ(desk.subscribe(client, first.cookie, 0).what, What::nothing);
  EXPECT_EQ(desk.subscriptions.active(), 0u);
}

TEST(Subscriptions, ClientGetsItsNextCookieBeforeTheOldOneExpires) {
  Desk desk;
  const Endpoint client = Desk::client(5000);
  std::uint64_t cookie = desk.subscribe(client, 0).cookie;
  ASSERT_EQ(desk.subscribe(client, cookie).what, What::begin);
  for (int second = 0; second < 600; ++second) {  // ten minutes without a gap
    desk.now += 1s;
    ASSERT_FALSE(desk.subscriptions.expire(desk.now));
    const auto outcome = desk.subscribe(client, cookie);
    ASSERT_EQ(outcome.what, What::change) << second;
    if (outcome.cookie != 0) cookie = outcome.cookie;
  }
  EXPECT_EQ(desk.subscriptions.counters.cookies, 1u + 10u);
}

TEST(Subscriptions, WrongCookieIsAnsweredWithAGoodOneAndCounted) {
  Desk desk;
  const auto outcome = desk.subscribe(Desk::client(5000), 12345);
  EXPECT_EQ(outcome.what, What::send_cookie);
  EXPECT_NE(outcome.cookie, 12345u);
  EXPECT_EQ(desk.subscriptions.counters.cookie_unknown, 1u);
}

TEST(Subscriptions, LimitRefusesAndSaysSoOnceButTheConfiguredDestinationAlwaysMay) {
  Desk desk;
  for (const int port : {5000, 5001}) {
    const auto cookie = desk.subscribe(Desk::client(port), 0).cookie;
    EXPECT_EQ(desk.subscribe(Desk::client(port), cookie).what, What::begin);
  }
  for (int i = 0; i < 3; ++i) {
    const auto cookie = desk.subscribe(Desk::client(5002), 0).cookie;
    const auto refused = desk.subscribe(Desk::client(5002), cookie);
    EXPECT_EQ(refused.what, What::nothing);
    EXPECT_EQ(refused.first_refusal, i == 0);
  }
  EXPECT_EQ(desk.subscriptions.counters.refused_full, 3u);
  const auto fixed = desk.subscribe(kFixed, desk.subscribe(kFixed, 0).cookie);
  EXPECT_EQ(fixed.what, What::begin);
  EXPECT_EQ(fixed.slot, 0u);
  EXPECT_EQ(desk.subscriptions.active(), 2u);
}

TEST(Subscriptions, OldAndRepeatedDatagramsChangeNothing) {
  Desk desk;
  const Endpoint client = Desk::client(5000);
  const auto cookie = desk.subscribe(client, 0).cookie;
  Request older = desk.request(client);
  older.message = protocol::Subscribe{cookie, 0, {}, 0, 0};  // would end it
  ASSERT_EQ(desk.subscribe(client, cookie).what, What::begin);
  EXPECT_EQ(desk.subscriptions.take(older, desk.now).what, What::nothing);
  Request again = desk.request(client);
  again.message = protocol::Subscribe{cookie, 7, {}, 0, 0};
  const auto changed = desk.subscriptions.take(again, desk.now);
  EXPECT_EQ(changed.what, What::change);
  EXPECT_FALSE(changed.restarted);
  EXPECT_EQ(desk.subscriptions.take(again, desk.now).what, What::nothing);
  EXPECT_EQ(desk.subscriptions.counters.outdated, 2u);
  Request restarted = desk.request(client, 6);  // the client started again on the same port
  restarted.seq = 1;
  restarted.message = protocol::Subscribe{cookie, 1, {}, 0, 0};
  const auto anew = desk.subscriptions.take(restarted, desk.now);
  EXPECT_EQ(anew.what, What::change);
  EXPECT_TRUE(anew.restarted);
}

TEST(Subscriptions, OnlySubscribersAreHeardWithANack) {
  Desk desk;
  const Endpoint client = Desk::client(5000);
  const auto cookie = desk.subscribe(client, 0).cookie;
  EXPECT_EQ(desk.nack(client, cookie).what, What::nothing);
  EXPECT_EQ(desk.subscriptions.counters.nacks_unsubscribed, 1u);
  ASSERT_EQ(desk.subscribe(client, cookie).what, What::begin);
  EXPECT_EQ(desk.nack(client, cookie).what, What::resend);
  EXPECT_EQ(desk.nack(client, cookie + 1).what, What::nothing);
  EXPECT_EQ(desk.subscriptions.counters.cookie_unknown, 1u);
  EXPECT_EQ(desk.subscriptions.counters.nack_tiles, 3u);
  desk.now += 2s;
  EXPECT_EQ(desk.nack(client, cookie).what, What::resend);
  EXPECT_EQ(desk.subscriptions.next_expiry(), desk.now + 3s) << "it renews the lease";
  for (int i = 0; i < 1000; ++i) desk.nack(client, cookie);
  EXPECT_EQ(desk.subscriptions.counters.nacks, 1u + 200u);  // 200 in one moment
  EXPECT_EQ(desk.subscriptions.counters.rate_limited, 801u);
  desk.now += 1s;
  EXPECT_EQ(desk.nack(client, cookie).what, What::resend);
}

TEST(Subscriptions, AnswersToUnprovenAddressesAreLimitedTogether) {
  Desk desk;
  int answered = 0;
  for (int ms = 0; ms < 1000; ++ms, desk.now += 1ms)
    for (int i = 0; i < 10; ++i) answered += desk.subscribe(Desk::client(1 + ms), 0).what == What::send_cookie ? 1 : 0;
  EXPECT_NEAR(answered, 1000, 21);  // a second's worth and one full bucket
  EXPECT_EQ(desk.subscriptions.counters.rate_limited, 10'000u - static_cast<unsigned>(answered));
  EXPECT_EQ(desk.subscriptions.active(), 0u);
}

}  // namespace
}  // namespace scree::node
