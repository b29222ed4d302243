#pragma once
// The vectorised loops of FootprintRisk: a piece of a row of cells at a time.

#include <array>

#include "core/grid.hpp"
#include "mapping/footprint.hpp"

namespace scree::mapping::risk_rows {

inline constexpr int kBlock = 128;  ///< cells; what is summed stays in the first cache

/// Inverse limits: of the tangents of pitch and roll, of the clearance. No load is taken for more than `most`; a load
/// of 1 − 1/(2·sharpness) begins to count as a violation and one of 1 + 1/(2·sharpness) is one.
struct Limits {
  float pitch, roll, clearance_m, most, sharpness;
};

/// Over the draws, per cell: sum, sum of squares and the two largest of the loads, and the number that violate.
struct Sums {
  alignas(64) std::array<float, kBlock> sum, square, first, second, violations;
  void clear() {
    for (auto* of : {&sum, &square, &first, &second, &violations}) of->fill(0.0F);
  }
};

/// best = max(best, |there − here|)
void raise_difference(const float* here, const float* there, int n, float* best);
/// best = √(best² + share·relief + face)·scale
void step_load(const float* relief_m2, float share, const float* face_m2, float scale, int n, float* best);
/// tops = draw + √(share·relief + face)
void add_peaks(const float* draw_m, const float* relief_m2, float share, const float* face_m2, int n, float* tops_m);

/// One draw: heights under wheels and belly, load of the step at each cell.
struct Surface {
  const Grid<float>&draw_m, &tops_m, &step;
};
/// best = max(best, `of` under each wheel) for the vehicle on n cells from (row, column).
void raise_under_wheels(const Footprint& footprint, const Grid<float>& of, int row, int column, int n, float* best);
/// The loads of one draw for the vehicle on cells (row, column) … (row, column + n − 1), n ≤ kBlock, into `sums`.
void add_loads(const Footprint& footprint, const Limits& limits, const Surface& surface, int row, int column, int n,
               Sums& sums);
/// Of K = `draws` loads: the probability of one above 1 (risk.hpp), its maximum with `worst`, and of the mean of the
/// two largest loads with `tail`.
void finish(const Sums& sums, int draws, float model_error, int n, float* probability, float* worst, float* tail);

}  // namespace scree::mapping::risk_rows
