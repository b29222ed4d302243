#pragma once
// Eight floats side by side: one per increment class. The compilers' vector extension makes them one AVX register, or
// two SSE registers in the baseline clone, with the same results; plain arrays of eight were left scalar by g++ 12
// (four times slower fits, docs/fractal.md).

#include <array>
#include <cstdint>
#include <cstring>

namespace scree::fractal {

using Lanes = float __attribute__((vector_size(32)));
using IntLanes = std::int32_t __attribute__((vector_size(32)));

// Forced inline: a clone for AVX2 must not call a baseline function. References, because the ABI of a 32-byte argument
// depends on the instruction set.
#define SCREE_INLINE inline __attribute__((always_inline))

SCREE_INLINE void load(const std::array<float, 8>& from, Lanes& out) {
  std::memcpy(&out, from.data(), sizeof out);
}

SCREE_INLINE float sum(const Lanes& v) {
  return ((v[0] + v[4]) + (v[2] + v[6])) + ((v[1] + v[5]) + (v[3] + v[7]));
}

/// Natural logarithm of positive normal floats to 2 ulp, branch-free, for float/int32 and their vectors alike.
/// x = 2^e·(1 + t), 1 + t in [√½, √2); polynomial of S. Moshier's Cephes logf.
template <class Float, class Int>
SCREE_INLINE void fast_log(const Float& x, Float& out) {
  const Int bits = __builtin_bit_cast(Int, x);
  const Int exponent = (bits - 0x3f3504f3) >> 23;
  const Int mantissa = bits - (exponent << 23);
  const Float t = __builtin_bit_cast(Float, mantissa) - 1.0F;
  Float e;
  if constexpr (sizeof(Int) == sizeof(std::int32_t))
    e = static_cast<Float>(exponent);
  else
    e = __builtin_convertvector(exponent, Float);
  const Float t2 = t * t;
  // Estrin's grouping: the fits wait for this chain, not for its operations.
  const Float p0 = 3.3333331174e-1F - 2.4999993993e-1F * t, p1 = 2.0000714765e-1F - 1.6668057665e-1F * t;
  const Float p2 = 1.4249322787e-1F - 1.2420140846e-1F * t, p3 = 1.1676998740e-1F - 1.1514610310e-1F * t;
  const Float t4 = t2 * t2;
  const Float p = (p0 + p1 * t2) + t4 * ((p2 + p3 * t2) + 7.0376836292e-2F * t4);
  out = t + (p * t * t2 - 0.5F * t2 - 2.12194440e-4F * e) + 0.693359375F * e;
}

/// e^x for −87 ≤ x ≤ 88 to 1 ulp or so, inline where a call would spill every lane. x = n·ln 2 + t, |t| ≤ ½ ln 2;
/// polynomial of S. Moshier's Cephes expf.
SCREE_INLINE float fast_exp(float x) {
  constexpr float kMagic = 12582912.0F;  // 1.5·2^23: adding it rounds to whole numbers
  const float shifted = x * 1.44269504F + kMagic;
  const float n = shifted - kMagic;
  const float t = (x - n * 0.693359375F) + n * 2.12194440e-4F;
  const float t2 = t * t;
  const float p0 = 5.0000001201e-1F + 1.6666665459e-1F * t, p1 = 4.1665795894e-2F + 8.3334519073e-3F * t;
  const float p2 = 1.3981999507e-3F + 1.9875691500e-4F * t;
  const float p = 1.0F + (t + t2 * (p0 + t2 * (p1 + t2 * p2)));
  const std::int32_t exponent = __builtin_bit_cast(std::int32_t, shifted) - __builtin_bit_cast(std::int32_t, kMagic);
  return p * __builtin_bit_cast(float, (exponent + 127) << 23);
}

}  // namespace scree::fractal
