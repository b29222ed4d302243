#pragma once
// Two fractional Brownian profiles that know of each other.

#include <cstdint>
#include <vector>

#include "core/result.hpp"

namespace scree::fractal {

/// Heights at 0, 1, … count − 1, zero at 0.
struct ProfilePair {
  std::vector<double> first, second;
};

/// The time-reversible bivariate fBm: each profile an exact fBm of unit variogram |t|^(2H), and with h = H1 + H2
///   cov(f1(s), f2(t)) = ρ/2 · (|s|^h + |t|^h − |s − t|^h),
/// so increments of both over one and the same interval have the correlation ρ, whatever its place and length. Exact,
/// by circulant embedding of the increments as pairs. Reproducible from the seed alone.
/// Errors, usage: H outside (0, 1), count < 2 or > 2^24, |ρ| above what the embedding has: .2 % (H = .3, .6) to 3 %
/// (.1, .9) less than max_profile_correlation(), from some fifty values on. Cost: O(count log count). Source: [ACLP13].
Result<ProfilePair> fbm_profile_pair(double hurst_1, double hurst_2, double correlation, int count, std::uint64_t seed);

/// The largest correlation there is: √(Γ(2H1+1)Γ(2H2+1) sin πH1 sin πH2) / (Γ(h+1) sin(πh/2)), 1 for H1 = H2 only.
double max_profile_correlation(double hurst_1, double hurst_2);

}  // namespace scree::fractal
