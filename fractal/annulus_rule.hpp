#pragma once
// Which annulus a distance belongs to, in float32: one expression for scalar and vectorised code, so that every route
// counts the same pairs.

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "fractal/lanes.hpp"
#include "fractal/structure_function.hpp"

namespace scree::fractal {

/// Annulus coordinate t = scale·u + shift with u the distance or its logarithm: annulus k spans k + ½ ± half of t.
struct AnnulusRule {
  float scale = 1.0F, shift = 0.0F, half = 0.5F;
  int count = 0;  ///< also the key of pairs in no annulus

  explicit AnnulusRule(const Annuli& annuli) : count(annuli.count) {
    const bool uniform = annuli.spacing == Annuli::Spacing::uniform;
    const double width = uniform ? annuli.step : std::log(annuli.step);
    const double first = uniform ? annuli.first_m : std::log(annuli.first_m);
    scale = static_cast<float>(1.0 / width);
    shift = static_cast<float>(0.5 - first / width);
    half = static_cast<float>(annuli.half_width / width);
  }
};

SCREE_INLINE void square_root(const float& x, float& out) {
  out = std::sqrt(x);
}
SCREE_INLINE void square_root(const Lanes& x, Lanes& out) {
  for (int l = 0; l < 8; ++l) out[l] = std::sqrt(x[l]);  // one instruction where errno is not asked for
}
SCREE_INLINE void truncate(const float& x, std::int32_t& out) {
  out = static_cast<std::int32_t>(x);
}
SCREE_INLINE void truncate(const Lanes& x, IntLanes& out) {
  out = __builtin_convertvector(x, IntLanes);
}
SCREE_INLINE void convert(const std::int32_t& x, float& out) {
  out = static_cast<float>(x);
}
SCREE_INLINE void convert(const IntLanes& x, Lanes& out) {
  out = __builtin_convertvector(x, Lanes);
}

/// Squared distance in m² to annulus and to ln(distance), for one pair (float) or eight (Lanes): `key` is `count`
/// outside of all annuli. No branches.
template <Annuli::Spacing kSpacing, class Float, class Int>
SCREE_INLINE void find_annulus(const AnnulusRule& rule, const Float& r2, Int& key, Float& log_distance) {
  fast_log<Float, Int>(r2, log_distance);
  log_distance *= 0.5F;
  Float u = log_distance;
  if constexpr (kSpacing == Annuli::Spacing::uniform) square_root(r2, u);
  const Float end = Float{} + static_cast<float>(rule.count), below = Float{} - 0.75F;
  Float t = u * rule.scale + rule.shift;
  t = t < end ? t : end;
  t = t > below ? t : below;  // truncates to annulus 0 and lies outside of it
  Int k;
  truncate(t, k);
  Float index;
  convert(k, index);
  const Float off = t - (index + 0.5F);
  const Int none = Int{} + rule.count;
  key = off >= -rule.half ? k : none;
  key = off < rule.half ? key : none;
}

/// One distance at a time.
inline int annulus_of(const AnnulusRule& rule, Annuli::Spacing spacing, float dx, float dy) {
  std::int32_t key = 0;
  float log_distance = 0.0F;
  const float r2 = dx * dx + dy * dy;
  if (spacing == Annuli::Spacing::uniform)
    find_annulus<Annuli::Spacing::uniform>(rule, r2, key, log_distance);
  else
    find_annulus<Annuli::Spacing::geometric>(rule, r2, key, log_distance);
  return key;
}

}  // namespace scree::fractal
