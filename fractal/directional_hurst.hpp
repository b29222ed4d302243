#pragma once
// H along twelve azimuths, from the second differences of a lattice at all offsets.

#include <array>
#include <limits>

#include "core/executor.hpp"
#include "fractal/increments.hpp"
#include "fractal/support.hpp"

namespace scree::fractal {

inline constexpr int kAzimuthCount = 12;  ///< 15° apart: the other twelve of the 24 point the opposite way
inline constexpr int kMinAzimuthLag_cells = 4, kMaxAzimuthLag_cells = 32;

/// The isotropic law that directions are compared with; lags in cells.
struct IsotropicLaw {
  Support support = Support::centre_point;
  double hurst = 0.5;
  double c_m2 = 1.0;      ///< squared height change at lag 1 cell
  double noise_m2 = 0.0;  ///< white, of a cell value: measurement noise and the nugget of few returns
};

struct DirectionalHurst {
  std::array<double, kAzimuthCount> hurst;  ///< at 0°, 15°, … 165° from +x, counter-clockwise; NaN: too little data
  double index_v = std::numeric_limits<double>::quiet_NaN();  ///< (max H − min H)/mean H over the azimuths
  int max_lag_cells = 0;
};

/// A quarter of the window, the window being no larger than its known cells would fill; within the limits above.
int azimuth_lag_cells(int rows, int columns, double known_cells);

/// For every offset o up to max_lag_cells, the mean of [z(p − o) − 2 z(p) + z(p + o)]² over all complete triples, less
/// its noise, over what `law` expects; H(θ) = law.hurst + half the slope of the logarithm of this ratio against ln |o|.
/// An offset counts for the azimuths within 30°, falling off linearly, with weight triples/|o|³ (offsets of one length
/// are not independent, and there are more of the long ones). What depends on the angle alone is fitted beforehand, by
/// two harmonics, and taken off: a stretch changes C(θ), not H(θ).
/// Exact for power laws at centre points: the expectation along θ is (4 − 4^H(θ))·C(θ)·|o|^(2H(θ)). Second differences
/// and not pairs, because a tilt has no place in them. Lattices of more than 2^18 cells are sampled by rows.
/// Cost: 1.6·max_lag² triples a cell. Source: [X09] section 3, with all directions measured over the whole surface.
DirectionalHurst directional_hurst(const MaskedHeights& heights, const IsotropicLaw& law, int max_lag_cells,
                                   Executor& executor);

}  // namespace scree::fractal
