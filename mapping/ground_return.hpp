#pragma once
// One cell, one frame: which of its returns are the ground, and what height they say.

#include <span>

#include "mapping/map_cell.hpp"

namespace scree::mapping {

struct GroundConfig {
  float cell_m = 0.1F;
  float overhang_m = 1.0F;      ///< what hangs this much above the ground is no obstacle
  float outlier_sigmas = 5.0F;  ///< agreement with the stored height
};

/// What the map already holds for the cell; variance < 0 = nothing.
struct StoredHeight {
  float height_m = 0.0F;
  float variance_m2 = -1.0F;
};

struct GroundReturn {
  float height_m = 0.0F;            ///< mean of the chosen surface
  float bottom_m = 0.0F;            ///< lowest return of all that is below the overhang, ground level included
  float noise_variance_m2 = 0.0F;   ///< of the mean: independent range noise
  float shared_variance_m2 = 0.0F;  ///< of the mean: errors that the whole frame shares (filled by FrameReturns)
  float place_variance_m2 = 0.0F;   ///< of a single return: see MapCell (filled by FrameReturns)
  float against_map_m2 = -1.0F;     ///< what alignment left open between frame and map here; < 0 = not aligned
  float relief_m2 = 0.0F;           ///< variance of the returns below the overhang about height_m, less their noise
  int hits = 0;                     ///< returns averaged
  int others = 0;                   ///< returns of other surfaces in the cell
};

/// As height_variance_m2 of a cell that holds this frame alone, without what the frame shares.
inline float own_variance_m2(const GroundReturn& frame, float cell_m) {
  return height_variance_m2(frame.noise_variance_m2, frame.place_variance_m2, frame.relief_m2, frame.hits, cell_m);
}

/// Splits the heights of one cell at vertical gaps wider than max(2 cells, 6 sigma) and never averages across one. Of
/// the surfaces found, those that hang `overhang_m` or more above the lowest (that has a tenth of the returns) are
/// ignored; of the rest, the one that agrees with the stored height and has a quarter of the returns is taken, else the
/// one with the most returns (the higher of two equals). The relief covers all that is below the overhang, so it
/// keeps what its height leaves out.
/// Of the variance v of a return, v/k is left in the mean of k.
/// `heights_m` (not empty) is sorted when there is more than one surface. O(n log n) then.
GroundReturn ground_return(std::span<float> heights_m, std::span<const float> variances_m2, const StoredHeight& stored,
                           const GroundConfig& config);

}  // namespace scree::mapping
