#pragma once
// How large the index V of isotropic ground is by chance.

namespace scree::fractal {

/// 95 % quantile of the index V of directional_hurst on isotropic fBm with exponent `hurst`, known everywhere on
/// side × side cells, lags to a quarter of it. From simulations (tests/bench/anisotropy_bench.cpp prints the table),
/// interpolated in ln side and H; beyond the table it falls like 1/side. NaN below 16 cells.
double index_v_null95(double side_cells, double hurst);

}  // namespace scree::fractal
