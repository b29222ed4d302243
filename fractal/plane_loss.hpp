#pragma once
// What taking off the least-squares plane takes from a structure function.

#include <Eigen/Core>

#include "fractal/lag_statistics.hpp"

namespace scree::fractal {

/// The plane of a survey is fitted to the ground itself and removes part of its long waves: a structure function of the
/// residuals bends down, and read as a power law it would give too large a D (by .1 – .4 for smooth ground). With b the
/// slope of the plane and a pair u apart,
///   E(Δz − b·u)² = γ(u) − 2 E[Δz b]·u + uᵀE[b bᵀ]u,
/// and b is linear in the heights, so the difference is a linear functional of the variogram γ for any ground: a matrix
/// of weights, one row a lag, on the values of γ at fixed distances. The weights depend on where the points are and on
/// nothing else; they are computed from a sample.
struct PlaneLoss {
  Eigen::VectorXd distances;  ///< where γ is wanted, spacings
  Eigen::MatrixXd weights;    ///< lags × distances
  Eigen::VectorXd slope;      ///< weights for E|b|², the mean-square slope of the plane

  /// Cost: lags × sample² additions: some milliseconds.
  explicit PlaneLoss(const LagStatistics& statistics);
};

}  // namespace scree::fractal
