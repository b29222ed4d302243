#pragma once
// Proof that a client gets what is sent to its address, without keeping anything for those who never prove it.

#include <array>
#include <cstdint>

#include "core/result.hpp"
#include "core/time.hpp"
#include "node/udp_socket.hpp"

namespace scree::node {

class CookieJar {
 public:
  static constexpr Duration kSlot = std::chrono::seconds(60);
  enum class Verdict : std::uint8_t {
    bad,    ///< not of this address, or too old
    aging,  ///< good, but not for another slot: time for the next one
    good,
  };

  /// With a random key, so that cookies do not outlive the process. Errors: unavailable (no randomness).
  static Result<CookieJar> open();
  explicit CookieJar(const std::array<std::uint8_t, 16>& key) : key_(key) {}

  /// SipHash-2-4 of address, port and the minute of `now`; never 0. Good for 60 to 120 s.
  std::uint64_t cookie(const Endpoint& client, MonotonicTime now) const;
  Verdict check(std::uint64_t cookie, const Endpoint& client, MonotonicTime now) const;

 private:
  std::uint64_t of_slot(const Endpoint& client, std::int64_t slot) const;

  std::array<std::uint8_t, 16> key_;
};

}  // namespace scree::node
