#pragma once
// The default method: posterior mean, draws and standard deviation of every cell.

#include <cstddef>

#include "core/executor.hpp"
#include "core/result.hpp"
#include "fractal/reconstruction/cell_samples.hpp"
#include "fractal/reconstruction/surface_problem.hpp"

namespace scree::fractal {

struct ConditionalOptions {
  int residual_fields = 8;    ///< K ≥ 1 behind the standard deviation; at least as many as draws are made
  double tolerance = 0.05;    ///< stop at r·z < tolerance²·cells (at most 0.02 where any D < 2.3; of fields less)
  int max_iterations = 200;   ///< cycles of one solve
  bool gate_outliers = true;  ///< leave out data that neither ground of the law nor their neighbours explain
  bool break_edges = false;   ///< let the surface break at cliffs and rocks, and say there how little is known
  /// Height of the lowest ray that passed over each cell, metres, where it passes the middle; NaN or +inf = none.
  /// Empty: none anywhere. What stands above is pushed below.
  Grid<float> ceiling_m = {};
};

/// Mean A⁻¹·c·d with the blend prior (multigrid.hpp); draw k = mean + r_k, residual r_k = u_k − A⁻¹(c·u_k + √c·n_k)
/// with u_k an unconditional field of the law and n_k white noise: r_k has the law of the mean's true error whatever
/// the prior [CD12 ch. 7]. sd_m by SdMap from the K residuals. D is clamped to [2.05, 2.95]. One law or one a cell.
/// Gate: outlier_gate.hpp; the estimate says which data it cost, and none where it
/// would be more than a quarter of them (law_contradicted). Breaks: line_process.hpp for the mean, the edges also
/// for the residuals; variances grow beside them by what data left out show (break_inflation.hpp). Ceilings:
/// ceiling_push.hpp for every field; the mean moves by the mean push, the sd by how the spread of the fields changes
/// (ceiling_sums.hpp), so more fields help. With breaks or ceilings draws are given at the end, held until then.
/// Everything is keyed on request.seed and does not depend on the executor. iterations: cycles of all solves together.
/// Errors: those of check_surface (one measured cell is enough: the sd then grows with the distance from it); a law map
/// of another shape or with values out of range; residual_fields < 1; a side above DistanceTransform::kMaxSide.
/// Cost: K + 1 solves and K Fourier syntheses on a square about the longer side, linear in cells for
/// squares; the gate 7 warm solves, breaks some 15 longer ones,
/// ceilings 3 a field (docs/reconstruction.md). Memory:
/// conditional_memory_bytes.
Result<SurfaceEstimate> reconstruct_conditional(const CellSamples& samples, const SurfaceRequest& request,
                                                const ConditionalOptions& options, Executor& executor);

/// What makes a reconstruction larger than its grid says.
struct ConditionalLoad {
  int gap_cells = -1;  ///< widest hole in the data (data_gaps.hpp); −1: a thirtieth of the longer side
  int kept_draws = 0;  ///< with breaks or ceilings every draw is kept until the end
  bool ceilings = false;
};

/// What reconstruct_conditional holds at its peak for a grid, in bytes, its samples, law map and result included: about
/// 100 a cell for one law on large grids, 180 for a law a cell (measured: docs/reconstruction.md). The torus of the
/// fields is square: a strip needs, and takes, what the square of its longer side would.
std::size_t conditional_memory_bytes(int rows, int columns, bool law_varies, const ConditionalLoad& load = {});

}  // namespace scree::fractal
