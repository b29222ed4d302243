#pragma once
// Combined fractal Brown surfaces: another H along x than along y.

#include <cstdint>

#include "core/grid.hpp"
#include "core/result.hpp"

namespace scree::fractal {

/// z(x, y) = p·f_x(x) + (1 − p)·f_y(y), f_x and f_y fBm profiles of H_x and H_y whose increments have the correlation
/// ρ. Source: [X09] eq. 10.
struct CombinedLaw {
  double hurst_x = 0.5, hurst_y = 0.5;
  double weight = 0.5;       ///< p
  double correlation = 0.0;  ///< ρ
  double amplitude_m = 0.1;  ///< rms change of f_x and of f_y over 1 m: σ_x = σ_y
};

/// Exact for this reading of the paper: its eq. 11 asks for cov(Δf_x, Δf_y) = ρσ_xσ_y·Δx^H_x·Δy^H_y wherever the
/// increments start, which no process has (increments that follow each other add, these covariances do not). The
/// reversible bivariate fBm (profile_pair.hpp) has it for increments from a point of the line x = y over Δx = Δy, and
/// elsewhere what follows from that. Float32 metres, zero at cell (0, 0). Reproducible from the seed alone.
/// Errors, usage: fewer than 2 × 2 cells, H outside (0, 1), weight outside [0, 1], amplitude or cell not positive, a
/// correlation too large for H_x and H_y (fbm_profile_pair()). Cost: O(rows·columns).
Result<Grid<float>> combined_surface(const CombinedLaw& law, int rows, int columns, double cell_m, std::uint64_t seed);

/// E|z(p + d) − z(p)|² for p on the line x = y and d = lag_m·(cos θ, sin θ), 0 ≤ θ ≤ π/2:
///   A + B + C, A = p²σ²|Δx|^2H_x, B = (1−p)²σ²|Δy|^2H_y, C = p(1−p)ρσ²(|Δx|^h + |Δy|^h − |Δx − Δy|^h), h = H_x + H_y.
/// [X09] eq. 13, with C as it can be: the two agree at θ = 0, 45° and 90°.
double combined_squared_change(const CombinedLaw& law, double azimuth_rad, double lag_m);

/// ½·d ln E|Δz|² / d ln lag = H_x + (B + C/2)(H_y − H_x)/(A + B + C). [X09] eq. 16 has −(B + C/2) by a misprint: its
/// own conclusion 1 (H = H_y at 90°) and eq. 15 ask for the plus.
double combined_hurst(const CombinedLaw& law, double azimuth_rad, double lag_m);

}  // namespace scree::fractal
