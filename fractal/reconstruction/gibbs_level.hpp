#pragma once
// One level of the paper's sampler: Gauss–Seidel relaxation or Gibbs sampling of a 13-point blend with data.

#include <cstdint>

#include "core/grid.hpp"
#include "fractal/reconstruction/blend_prior.hpp"

namespace scree::fractal {

/// A = w1·L + w2·L² + diag(precision), L the 5-point graph Laplacian with half-sample reflection (no flux) at the
/// borders; any size from 1 × 1. Energy ½x'Ax − right'x, unit temperature: a temperature T is weights over T.
struct GibbsLevel {
  BlendWeights weights;
  Grid<float> precision;  ///< of the data, ≥ 0; 0 = none
  Grid<float> right;
  Grid<float> variance;  ///< 1/A_ii, of a cell given all others; set by finish()

  void finish();
  int rows() const { return precision.rows(); }
  int columns() const { return precision.columns(); }
};

/// Where the noise of a sweep comes from. Every cell of every sweep has its own number whatever the order.
struct SweepNoise {
  std::uint64_t seed = 1;
  std::uint64_t stream = 0;  ///< of the sweep
};

/// One sweep in raster order: x_i ← its expectation given all other cells, plus, where `noise` is not null, normal
/// noise of variance 1/A_ii. Scalar, as in [AK96] section 3.2.
void gibbs_sweep(const GibbsLevel& level, const SweepNoise* noise, Grid<float>& x);

/// Standard normals of row `row`, columns 0 … count − 1, four from one call of the generator (two Box–Muller pairs).
void normals_row(const SweepNoise& noise, int row, int count, float* out);

}  // namespace scree::fractal
