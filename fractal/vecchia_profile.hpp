#pragma once
// From sums of prediction errors to −2 log likelihood as a function of H alone, and from that to H and its interval.

#include <cmath>
#include <span>

#include "fractal/vecchia_lanes.hpp"

namespace scree::fractal {

/// Per lane, with plane and amplitude at their best.
struct LaneProfile {
  HurstLanes lanes;
  PerLane minus_two_log{};  ///< up to a constant
  PerLane log_c{};          ///< of the squared height change over the unit of length
  PerLane log_tau{};        ///< of the best τ, where the noise is known
  PerLane free_tau{};       ///< coordinate (FreeTau) of the best τ, where it is not
  PerLane tau_edge{};       ///< −1, 1: the best τ lies at the lowest, highest given one or beyond; 0 between
};

/// τ where the noise is unknown: coordinate u = ln(1 + τ/scale), 0 without noise, logarithmic for much of it. The scale
/// is a small part of what 13 neighbours leave unexplained, which vanishes with 1 − H: the sums are smooth in u.
struct FreeTau {
  double scale;
  explicit FreeTau(double hurst) : scale(0.1 * (1.0 - hurst)) {}
  double tau(double u) const { return scale * std::expm1(u); }
  double coordinate(double tau) const { return std::log1p(tau / scale); }
};

/// Of `count` points: one gives the level, two the plane.
double contrast_count(std::size_t count);

/// Without noise. `count` is the number of points behind the sums.
LaneProfile clean_profile(const HurstLanes& lanes, const ErrorSums& sums, std::size_t count);

/// With a noise variance > 0 and sums at ascending `taus`. Between them log S and log |…| are interpolated, by
/// polynomials through three nodes, or through all of them where `close` says that these stand less than a factor 1.5
/// apart. Below the lowest τ the sums there are used with the amplitude that suits them.
LaneProfile noisy_profile(const HurstLanes& lanes, std::span<const PerLane> taus, std::span<const ErrorSums> sums,
                          std::size_t count, double noise_variance, bool close);

/// With an unknown noise and sums at ascending coordinates `nodes` (FreeTau) of τ: the least over τ, by polynomials
/// through three nodes, or through all of them where `close`. A τ of 0 inside the nodes is no edge.
LaneProfile free_noise_profile(const HurstLanes& lanes, std::span<const PerLane> nodes, std::span<const ErrorSums> sums,
                               std::size_t count, bool close);

/// The minimum over H, by cubics through the lanes.
struct HurstFit {
  double hurst = 0.5;
  double sigma = 0.25;  ///< from the curvature, 0.25 where there is none; from the closed end where one is open
  double lane = 0.0;    ///< of the minimum, fractional
  double low = 0.0,
         high = 1.0;  ///< where −2 log L has risen by the 95 % quantile of χ²(1); the end lane where it has not
  bool low_open = false, high_open = false;
};
HurstFit fit_hurst(const LaneProfile& profile);

/// A lane-wise quantity between the lanes, by a cubic through the four nearest; constant outside.
double between_lanes(const PerLane& values, double lane);

}  // namespace scree::fractal
