#pragma once
// The oracle: exact conditional mean, standard deviation and simulation of fBm, dense.

#include <cstddef>

#include "core/executor.hpp"
#include "core/result.hpp"
#include "fractal/reconstruction/cell_samples.hpp"

namespace scree::fractal {

struct KrigingOptions {
  std::size_t max_samples = 8000;                               ///< measured cells
  std::size_t max_bytes = std::size_t{2} * 1024 * 1024 * 1024;  ///< matrix, grids and working memory together
};

/// Intrinsic kriging of the measured cells with the fBm variogram, an unknown constant and the cells' own noise.
/// mean_m and sd_m exact to rounding; sd_m is that of the surface, without the noise of a measurement. Draws:
/// conditional simulation by Matheron's rule with an exact unconditional fBm (of D within 2.05 … 2.95), the same for
/// the same seed. Where heights contradict the law the mean still interpolates them within their noise; the sd, which
/// does not look at heights, does not change. Errors: those of check_surface; usage for a varying law, and above
/// max_samples or max_bytes (the message names the limit and what would be needed). Cost for n cells measured: n³/3 +
/// n²·cells for the sd, n·cells
/// + one fBm a draw. Memory: n²·8 bytes + 48 bytes a cell. Source: [CD12] ch. 3, 4, 7.
Result<SurfaceEstimate> reconstruct_kriging(const CellSamples& samples, const SurfaceRequest& request,
                                            const KrigingOptions& options, Executor& executor);

}  // namespace scree::fractal
