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
  float shared_variance_m2 = 0.0F;  ///< of that mean: what the returns of a frame share (pose, phase)
  float relief_m2 = 0.0F;           ///< variance of single returns about the mean beyond their noise: slope, roughness
  std::uint16_t hits = 0;           ///< returns averaged, saturates
  std::uint8_t contradictions = 0;  ///< frames in a row whose returns disagreed
  std::uint8_t seen_through = 0;    ///< frames since the last hit whose rays passed below the height
  bool shadowed = false;            ///< inside the shadow of a return, in some frame
  /// Lowest upper bound that rays have set on the ground here; +inf = no ray crossed the cell.
  float ceiling_m = std::numeric_limits<float>::infinity();
  /// Where the ground on the sensor's side would have continued, for the ray of `ceiling_m`; -inf = nothing to expect.
  float lip_m = -std::numeric_limits<float>::infinity();

  bool measured() const { return hits > 0; }
};

// Errors that more returns do not average away: calibration, pose, the systematic part of quantisation.
inline constexpr float kSystematic_m = 0.005F;
// Sub-cell relief, as a share of the cell's side, until the cell's own returns tell (counts like kReliefPriorHits).
inline constexpr float kReliefPrior = 0.1F;
inline constexpr float kReliefPriorHits = 2.0F;
// Returns of one cell lie on few scan lines: beyond this many, their places are no longer independent.
inline constexpr int kIndependentPlaces = 16;

/// Variance of the mean of `hits` returns as an estimate of the cell's mean height: noise of the mean (its own and
/// shared), the systematic floor, and the sub-cell relief sampled at finitely many places.
inline float height_variance_m2(float noise_variance_m2, float relief_m2, int hits, float cell_m) {
  const float prior_m2 = kReliefPrior * kReliefPrior * cell_m * cell_m;
  const float n = static_cast<float>(hits);
  const float single_m2 = (kReliefPriorHits * prior_m2 + n * relief_m2) / (kReliefPriorHits + n);
  return noise_variance_m2 + kSystematic_m * kSystematic_m +
         single_m2 / static_cast<float>(std::clamp(hits, 1, kIndependentPlaces));
}

/// The number of randomly placed returns whose mean would miss the cell's mean height by as much as the mean of `hits`
/// returns of a scanner does: its places are regular, so the miss falls like hits^−(1+H), not 1/hits; H = 1/2 is taken.
/// This is the support that the estimator of D expects. Measured: docs/mapping.md.
inline std::uint16_t random_support(std::uint16_t hits) {
  const float n = static_cast<float>(hits);
  return static_cast<std::uint16_t>(std::min(n * std::sqrt(n) + 0.5F, 65535.0F));
}

inline float height_variance_m2(const MapCell& cell, float cell_m) {
  return height_variance_m2(cell.noise_variance_m2 + cell.shared_variance_m2, cell.relief_m2, cell.hits, cell_m);
}

}  // namespace scree::mapping
