#pragma once
// Counter-based random numbers: a value depends on (seed, stream, lattice coordinate) alone, so results never depend
// on order, threads or tiling.

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace scree {

/// Philox4x32-10, 128-bit counter and 64-bit key to four independent 32-bit words.
/// Source: [SM11] Salmon et al., "Parallel random numbers: as easy as 1, 2, 3", SC 2011; known answers in
/// tests/core/random_test.cpp.
constexpr std::array<std::uint32_t, 4> philox4x32(std::array<std::uint32_t, 4> counter,
                                                  std::array<std::uint32_t, 2> key) {
  for (int round = 0; round < 10; ++round) {
    const std::uint64_t p0 = std::uint64_t{0xD2511F53u} * counter[0];
    const std::uint64_t p1 = std::uint64_t{0xCD9E8D57u} * counter[2];
    counter = {static_cast<std::uint32_t>(p1 >> 32) ^ counter[1] ^ key[0], static_cast<std::uint32_t>(p1),
               static_cast<std::uint32_t>(p0 >> 32) ^ counter[3] ^ key[1], static_cast<std::uint32_t>(p0)};
    key[0] += 0x9E3779B9u;
    key[1] += 0xBB67AE85u;
  }
  return counter;
}

/// Four words for the lattice coordinate (x, y) of `stream` under `seed`.
constexpr std::array<std::uint32_t, 4> random_words(std::uint64_t seed, std::uint64_t stream, std::int32_t x,
                                                    std::int32_t y) {
  return philox4x32({static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y), static_cast<std::uint32_t>(stream),
                     static_cast<std::uint32_t>(stream >> 32)},
                    {static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32)});
}

/// Uniform in the open interval (0, 1), 32 bits of resolution.
constexpr double to_uniform(std::uint32_t word) {
  return (word + 0.5) * 0x1p-32;
}

/// Two independent standard normals for one lattice coordinate (Box–Muller).
inline std::array<double, 2> random_normals(std::uint64_t seed, std::uint64_t stream, std::int32_t x, std::int32_t y) {
  const auto words = random_words(seed, stream, x, y);
  const double radius = std::sqrt(-2.0 * std::log(to_uniform(words[0])));
  const double angle = 2.0 * std::numbers::pi * to_uniform(words[1]);
  return {radius * std::cos(angle), radius * std::sin(angle)};
}

}  // namespace scree
