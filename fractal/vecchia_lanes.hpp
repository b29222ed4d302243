#pragma once
// The hot part of the likelihood: prediction errors of each point from its predecessors, for sixteen values of H side
// by side.

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "fractal/vecchia_neighbours.hpp"

namespace scree::fractal {

inline constexpr int kHurstLanes = 16;
inline constexpr std::size_t kMaxTaus = 8;
using PerLane = std::array<double, kHurstLanes>;

/// H_k = first + k·step.
struct HurstLanes {
  double first = 0.02, step = 0.965 / (kHurstLanes - 1);
  double at(double lane) const { return first + lane * step; }
};

/// Sums over points for one τ a lane. e_f: error of predicting f ∈ {z, x, y} with the kriging weights of z; v: its
/// variance in units of C. Additive.
struct ErrorSums {
  PerLane zz{}, zx{}, zy{}, xx{}, xy{}, yy{};  ///< Σ e_f·e_g / v
  PerLane log_v{};                             ///< Σ log v
};

/// Adds points [1, count) of the survey to `sums`, one ErrorSums for each of at most
/// kMaxTaus `taus` (τ = s²/C per lane, with s² the
/// noise variance of a single point). Intrinsic kriging: the nearest predecessor is the reference, so that a constant
/// drops out. Cost a point: 91 logarithms and 182 exponentials shared by all lanes and all τ, then a factorisation of
/// order 13 a lane and τ.
void add_errors(std::span<const VecchiaPoint> points, std::span<const Predecessors> predecessors,
                const HurstLanes& lanes, std::span<const PerLane> taus, std::span<ErrorSums> sums);

}  // namespace scree::fractal
