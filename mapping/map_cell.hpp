#pragma once
// What the rolling map remembers of a cell.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace scree::mapping {

/// Heights are map-frame metres. A cell is measured when hits > 0; `ceiling_m` and `lip_m` are kept for every cell.
struct MapCell {
  float height_m = 0.0F;            ///< mean height of the returns fused
  float noise_variance_m2 = 0.0F;   ///< of that mean: range noise, independent from cell to cell
  float shared_variance_m2 = 0.0F;  ///< of that mean: what the returns of a frame share (pose, alignment)
  float place_variance_m2 = 0.0F;   ///< of a single return: it lies beside its true place, on a slope
  float relief_m2 = 0.0F;           ///< variance of single returns about the mean beyond their noise: slope, roughness
  std::uint16_t hits = 0;           ///< returns averaged, saturates
  std::uint8_t contradictions = 0;  ///< frames in a row whose returns disagreed, with the height or the ground around
  std::uint8_t seen_through = 0;    ///< frames since the last fused return whose rays passed below the height
  bool shadowed = false;            ///< inside the shadow of a return, in some frame
  bool lethal = false;              ///< was lethal when it was last measured (cost.hpp)
  bool crossed_twice = false;       ///< rays of two frames have set ceilings
  /// When a return was last fused, on the mapper's clock (wraps in 49 days); of a cell that was never measured: when
  /// one was last refused.
  std::uint32_t fused_ms = 0;
  /// Upper bound of the ground here: the second lowest that the rays of any frame have set, so that one stray return
  /// far below the ground bounds nothing; the only one while only one frame's rays crossed. +inf = none did.
  float ceiling_m = std::numeric_limits<float>::infinity();
  /// Where the ground on the sensor's side would have continued, for the ray of `ceiling_m`; -inf = nothing to expect.
  float lip_m = -std::numeric_limits<float>::infinity();
  float lowest_ceiling_m = std::numeric_limits<float>::infinity(), lowest_lip_m = 0.0F;  ///< of any frame

  bool measured() const { return hits > 0; }
  void lower_ceiling(float frame_ceiling_m, float frame_lip_m);
  void forget_height() {
    hits = 0;
    seen_through = 0;
    contradictions = 0;
  }
};

inline void MapCell::lower_ceiling(float frame_ceiling_m, float frame_lip_m) {
  const bool lower = frame_ceiling_m < lowest_ceiling_m, first = std::isinf(lowest_ceiling_m);
  if (first || (lower && crossed_twice)) {
    ceiling_m = first ? frame_ceiling_m : lowest_ceiling_m;
    lip_m = first ? frame_lip_m : lowest_lip_m;
  } else if (!lower && (!crossed_twice || frame_ceiling_m < ceiling_m)) {
    ceiling_m = frame_ceiling_m;
    lip_m = frame_lip_m;
  }  // else the second frame is the lower one: the first stays in force
  crossed_twice = !first;
  if (!lower) return;
  lowest_ceiling_m = frame_ceiling_m;
  lowest_lip_m = frame_lip_m;
}

// Errors that more returns do not average away: calibration, the systematic part of quantisation. What the simulated
// scanners leave on near ground that hundreds of returns have met (docs/mapping.md).
inline constexpr float kSystematic_m = 0.002F;
// Sub-cell relief, as a share of the cell's side, until the cell's own returns tell (counts like kReliefPriorHits).
inline constexpr float kReliefPrior = 0.1F;
inline constexpr float kReliefPriorHits = 2.0F;
// Returns of one cell lie on few scan lines, and on what stands out of rough ground: beyond this many, more returns
// tell no more of the cell's mean (docs/mapping.md).
inline constexpr int kIndependentPlaces = 4;

/// Variance of the mean of `hits` returns as an estimate of the cell's mean height: noise of the mean (its own and
/// shared), the returns' misplacement on the slope (the mean of many such returns is the ground blurred over the width
/// of the error, and misses the cell's own mean by as much as one does: measured, docs/mapping.md), the systematic
/// floor, and the sub-cell relief sampled at finitely many places: the returns' own, shrunk towards what is expected.
inline float height_variance_of_relief_m2(float noise_variance_m2, float place_variance_m2, float relief_m2, int hits,
                                          float expected_relief_m2) {
  const float n = static_cast<float>(hits);
  const float single_m2 = (kReliefPriorHits * expected_relief_m2 + n * relief_m2) / (kReliefPriorHits + n);
  return noise_variance_m2 + place_variance_m2 + kSystematic_m * kSystematic_m +
         single_m2 / static_cast<float>(std::clamp(hits, 1, kIndependentPlaces));
}

/// The same while no law of the ground is known.
inline float height_variance_m2(float noise_variance_m2, float place_variance_m2, float relief_m2, int hits,
                                float cell_m) {
  return height_variance_of_relief_m2(noise_variance_m2, place_variance_m2, relief_m2, hits,
                                      kReliefPrior * kReliefPrior * cell_m * cell_m);
}

/// Seconds from `then_ms` to `now_ms` on a clock that wraps; 0 where it went backwards (a recording begun again).
inline float age_s(std::uint32_t now_ms, std::uint32_t then_ms) {
  const auto elapsed_ms = static_cast<std::int32_t>(now_ms - then_ms);
  return elapsed_ms > 0 ? 1e-3F * static_cast<float>(elapsed_ms) : 0.0F;
}

/// The number of randomly placed returns whose mean would miss the cell's mean height by as much as the mean of `hits`
/// returns of a scanner does: its places are regular, so the miss falls like hits^−(1+H), not 1/hits; H = 1/2 is taken.
/// This is the support that the estimator of D expects. Measured: docs/mapping.md.
inline std::uint16_t random_support(std::uint16_t hits) {
  const float n = static_cast<float>(hits);
  return static_cast<std::uint16_t>(std::min(n * std::sqrt(n) + 0.5F, 65535.0F));
}

/// Without what the frames' poses have wrong: of the cell's height against its neighbours'.
inline float own_variance_m2(const MapCell& cell, float cell_m) {
  return height_variance_m2(cell.noise_variance_m2, cell.place_variance_m2, cell.relief_m2, cell.hits, cell_m);
}

inline float height_variance_m2(const MapCell& cell, float cell_m) {
  return cell.shared_variance_m2 + own_variance_m2(cell, cell_m);
}

}  // namespace scree::mapping
