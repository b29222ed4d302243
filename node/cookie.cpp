#include "node/cookie.hpp"

#include <sodium.h>

#include "node/protocol_bytes.hpp"

namespace scree::node {
namespace {

std::int64_t slot_of(MonotonicTime now) {
  return now.time_since_epoch() / CookieJar::kSlot;
}

}  // namespace

Result<CookieJar> CookieJar::open() {
  static_assert(crypto_shorthash_KEYBYTES == 16 && crypto_shorthash_BYTES == 8);
  if (sodium_init() < 0)
    return Error{ErrorKind::unavailable, "cookies: expected a source of randomness, found that libsodium has none"};
  std::array<std::uint8_t, 16> key;
  randombytes_buf(key.data(), key.size());
  return CookieJar(key);
}

std::uint64_t CookieJar::of_slot(const Endpoint& client, std::int64_t slot) const {
  std::array<std::uint8_t, 27> bound{};
  protocol::ByteWriter writer(bound);
  writer.put(static_cast<std::uint8_t>(client.v6));
  for (const std::uint8_t byte : client.address) writer.put(byte);
  writer.put(client.port);
  writer.put(slot);
  std::array<std::uint8_t, 8> hash{};
  crypto_shorthash(hash.data(), bound.data(), bound.size(), key_.data());
  const auto cookie = protocol::ByteReader(hash).get<std::uint64_t>();
  return cookie != 0 ? cookie : 1;
}

std::uint64_t CookieJar::cookie(const Endpoint& client, MonotonicTime now) const {
  return of_slot(client, slot_of(now));
}

CookieJar::Verdict CookieJar::check(std::uint64_t cookie, const Endpoint& client, MonotonicTime now) const {
  const std::int64_t slot = slot_of(now);
  if (cookie == of_slot(client, slot)) return Verdict::good;
  return cookie == of_slot(client, slot - 1) ? Verdict::aging : Verdict::bad;
}

}  // namespace scree::node
