#pragma once
// Stein's intrinsic circulant embedding: exact fractional Brownian increments from one Fourier transform.

#include <complex>
#include <cstdint>
#include <functional>
#include <vector>

#include "core/grid.hpp"

namespace scree::fractal {

/// Torus covariance that, plus a random plane, has the variogram E|z(p) − z(q)|² = |p − q|^(2H) (unit: cells) for every
/// lag up to `unit_cells`. With r = lag / unit_cells and α = 2H:
///   ρ(r) = c0 − r^α + c2·r² (r ≤ 1), β(R − r)³/r (1 < r ≤ R), 0 beyond; side = 2R·unit_cells.
/// Source: [S02] section 2.
struct FbmEmbedding {
  double hurst = 0.5;
  int side = 0;             ///< torus period M, cells
  double unit_cells = 0.0;  ///< longest lag with the exact law
  double plane_c2 = 0.0;    ///< c2: variance share of the random plane
  /// Eigenvalues of the circulant at frequencies (u, v), 0 ≤ u, v ≤ M/2, row-major in v; even in u and v.
  std::vector<double> eigenvalues;

  /// Standard deviation of each of the two plane slopes, per cell, for the unit variogram above.
  double plane_slope_sigma() const;
};

/// Smallest smooth torus side for exact lags up to `longest_lag_cells`: 2 of them for H ≤ 0.75, 4 above.
int embedding_side(double hurst, double longest_lag_cells);

/// The embedding on a given torus; its exact lags reach side/2 (H ≤ 0.75) or side/4. 0 < H < 1, side even.
/// Cost: O(side² log side), quarter-size storage.
FbmEmbedding make_embedding(double hurst, int side);

/// Fills `row` with the `side` complex standard normals (unit variance in each part) of frequency row v, 0 ≤ v ≤
/// side/2.
using WhiteNoiseRow = std::function<void(int v, std::complex<float>* row)>;

/// White noise keyed on (seed, stream, frequency): reproducible from the seed alone.
WhiteNoiseRow keyed_white_noise(std::uint64_t seed, std::uint64_t stream, int side);

/// The stationary part of the field on cells [0, rows) × [0, columns) of the torus (both ≤ side), float32, with the
/// unit variogram above once the random plane is added. Cost: side/2 + columns/2 transforms of length `side`.
Grid<float> embedded_field(const FbmEmbedding& embedding, const WhiteNoiseRow& white, int rows, int columns);

}  // namespace scree::fractal
