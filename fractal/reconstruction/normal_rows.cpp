#include "fractal/reconstruction/normal_rows.hpp"

#include <bit>
#include <cmath>

#include "core/simd.hpp"

namespace scree::fractal {
namespace {

struct Words {
  std::uint32_t a, b, c, d;
};

/// philox4x32 of core/random.hpp, written so that a loop around it is vectorised.
inline __attribute__((always_inline)) Words philox(Words x, std::uint32_t key0, std::uint32_t key1) {
  for (int round = 0; round < 10; ++round) {
    const std::uint64_t p0 = std::uint64_t{0xD2511F53u} * x.a, p1 = std::uint64_t{0xCD9E8D57u} * x.c;
    x = {static_cast<std::uint32_t>(p1 >> 32) ^ x.b ^ key0, static_cast<std::uint32_t>(p1),
         static_cast<std::uint32_t>(p0 >> 32) ^ x.d ^ key1, static_cast<std::uint32_t>(p0)};
    key0 += 0x9E3779B9u;
    key1 += 0xBB67AE85u;
  }
  return x;
}

/// −ln u for u = (⌊w/2⁹⌋ + ½)·2⁻²³: exponent and a series in s = (m − 1)/(m + 1), m in [√½, √2).
inline __attribute__((always_inline)) float minus_log(std::uint32_t word) {
  const float u = (static_cast<float>(static_cast<std::int32_t>(word >> 9)) + 0.5F) * 0x1p-23F;
  const auto bits = std::bit_cast<std::int32_t>(u);
  const std::int32_t exponent = (bits - 0x3f3504f3) >> 23;  // of √½
  const float m = std::bit_cast<float>(bits - (exponent << 23));
  const float s = (m - 1.0F) / (m + 1.0F), s2 = s * s;
  const float series = 2.0F + s2 * (0.66666669F + s2 * (0.39999478F + s2 * (0.28605872F + s2 * 0.23283052F)));
  return -(static_cast<float>(exponent) * 0.693147181F + s * series);
}

/// sin(2πt) for |t| ≤ ¼.
inline __attribute__((always_inline)) float sine_of_turn(float t) {
  const float x = 6.28318531F * t, x2 = x * x;
  return x * (1.0F + x2 * (-0.166666667F + x2 * (8.33333333e-3F + x2 * (-1.98412698e-4F +
                                                                        x2 * (2.75573192e-6F - x2 * 2.50521084e-8F)))));
}

inline __attribute__((always_inline)) void box_muller(std::uint32_t first, std::uint32_t second, float& x, float& y) {
  const float radius = std::sqrt(2.0F * minus_log(first));
  const float t = static_cast<float>(static_cast<std::int32_t>(second)) * 0x1p-32F;  // [−½, ½]
  const float away = t < 0.0F ? -t : t;
  x = radius * sine_of_turn(0.25F - away);
  const float half = t < 0.0F ? -0.5F : 0.5F;
  y = radius * sine_of_turn(away > 0.25F ? half - t : t);
}

}  // namespace

SCREE_CLONES void normal_block(std::uint64_t seed, std::uint64_t stream, int row, int lanes, float* out) {
  const auto key0 = static_cast<std::uint32_t>(seed), key1 = static_cast<std::uint32_t>(seed >> 32);
  const auto low = static_cast<std::uint32_t>(stream), high = static_cast<std::uint32_t>(stream >> 32);
  float* __restrict out0 = out;
  float* __restrict out1 = out + lanes;
  float* __restrict out2 = out + 2 * static_cast<std::ptrdiff_t>(lanes);
  float* __restrict out3 = out + 3 * static_cast<std::ptrdiff_t>(lanes);
  for (int i = 0; i < lanes; ++i) {
    const Words w = philox({static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(row), low, high}, key0, key1);
    box_muller(w.a, w.b, out0[i], out1[i]);
    box_muller(w.c, w.d, out2[i], out3[i]);
  }
}

}  // namespace scree::fractal
