#pragma once
// Synthesis of fractional Brownian surfaces.

#include <cstdint>

#include "core/grid.hpp"
#include "core/result.hpp"

namespace scree::fractal {

/// D = 3 − H with 2 < D < 3. `amplitude_m` is the rms height change between points 1 m apart, so
/// E|z(p) − z(q)|² = amplitude_m² · (|p − q| / 1 m)^(2H).
struct FractalLaw {
  double dimension = 2.5;
  double amplitude_m = 0.1;
  double hurst() const { return 3.0 - dimension; }
  /// rms height change at `lag_m` metres
  double rms_change_m(double lag_m) const;
  /// rms second difference z(p + r) − 2 z(p) + z(p − r) over r = `lag_m` metres: √(4 − 4^H) times the rms change. A
  /// plane adds nothing to it, and it is what second-difference estimators measure: where H nears 1 and the amplitude
  /// grows without bound, this stays put.
  double rms_bend_m(double lag_m) const;
};

/// Exact fBm on a rows × columns lattice of pitch `cell_m` by Stein's intrinsic circulant embedding, float32 metres,
/// zero at cell (0, 0). Reproducible from the seed alone. Validity: 2.05 ≤ D ≤ 2.95. Errors: usage.
/// Cost: O(M² log M), M ≈ 2–4 × the patch diagonal in cells. Source: [S02] Stein 2002.
Result<Grid<float>> fbm_surface(const FractalLaw& law, int rows, int columns, double cell_m, std::uint64_t seed);

}  // namespace scree::fractal
