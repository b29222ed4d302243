#pragma once
// Eight doubles side by side: one AVX-512 register, or two or four smaller ones, with the same results.

#include <bit>
#include <cstdint>
#include <cstring>

#include "fractal/lanes.hpp"

namespace scree::fractal {

using WideLanes = double __attribute__((vector_size(64)));
using WideWords = std::uint64_t __attribute__((vector_size(64)));

SCREE_INLINE void load(const double* from, WideLanes& out) {
  std::memcpy(&out, from, sizeof out);
}
SCREE_INLINE void store(const WideLanes& from, double* to) {
  std::memcpy(to, &from, sizeof from);
}

/// Binary logarithm of positive normal doubles, relative error of 2^log below 1e-14. x = 2^e·m, m in [√½, √2);
/// log m = 2 artanh((m − 1)/(m + 1)) by its series, whose first neglected term is below 1e-18.
SCREE_INLINE void log2_of(const WideLanes& x, WideLanes& out) {
  constexpr std::uint64_t kRootHalf = 0x3fe6a09e667f3bcd, kBias = std::uint64_t{1023} << 52;
  const auto bits = __builtin_bit_cast(WideWords, x);
  // Exponent + 1023 as an integer, then as a double through the mantissa of 2^52.
  const WideWords exponent = (bits + (kBias - kRootHalf)) >> 52;
  const auto mantissa = __builtin_bit_cast(WideLanes, bits - (exponent << 52) + kBias);
  const WideLanes e = __builtin_bit_cast(WideLanes, exponent | (std::uint64_t{0x433} << 52)) - (0x1p52 + 1023.0);
  const WideLanes s = (mantissa - 1.0) / (mantissa + 1.0), s2 = s * s;
  WideLanes p = 1.0 / 19 + s2 * (1.0 / 21);
  p = 1.0 / 17 + s2 * p;
  p = 1.0 / 15 + s2 * p;
  p = 1.0 / 13 + s2 * p;
  p = 1.0 / 11 + s2 * p;
  p = 1.0 / 9 + s2 * p;
  p = 1.0 / 7 + s2 * p;
  p = 1.0 / 5 + s2 * p;
  p = 1.0 / 3 + s2 * p;
  p = 1.0 + s2 * p;
  constexpr double kTwoOverLog2 = 2.8853900817779268;
  out = e + kTwoOverLog2 * (s * p);
}

/// 2^x for |x| < 1000, relative error below 1e-14: Taylor's series on |fraction| ≤ ½.
SCREE_INLINE void exp2_of(const WideLanes& x, WideLanes& out) {
  constexpr double kRound = 0x1.8p52;  // adding it leaves the nearest integer in the low bits
  const WideLanes shifted = x + kRound;
  const WideLanes y = (x - (shifted - kRound)) * 0.69314718055994531;
  WideLanes p = 1.0 / 39916800 + y * (1.0 / 479001600);
  p = 1.0 / 3628800 + y * p;
  p = 1.0 / 362880 + y * p;
  p = 1.0 / 40320 + y * p;
  p = 1.0 / 5040 + y * p;
  p = 1.0 / 720 + y * p;
  p = 1.0 / 120 + y * p;
  p = 1.0 / 24 + y * p;
  p = 1.0 / 6 + y * p;
  p = 0.5 + y * p;
  p = 1.0 + y * p;
  p = 1.0 + y * p;
  out =
      __builtin_bit_cast(WideLanes, __builtin_bit_cast(WideWords, p) + (__builtin_bit_cast(WideWords, shifted) << 52));
}

}  // namespace scree::fractal
